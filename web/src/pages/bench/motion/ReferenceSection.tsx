import { Button, Group, SegmentedControl } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import type { Schemas } from "../../../api/client";
import { type AxisAddress, motion } from "../../../api/motion";
import { can, type Device } from "../../../api/queries";
import { withUnit } from "../../../lib/format";
import { SearchProgress } from "./SearchProgress";
import { setZero } from "./setZero";
import type { Action } from "./useAction";
import { searchKey, useSearch } from "./useSearch";

interface Props {
  at: AxisAddress;
  device: Device;
  action: Action;
  disabled: boolean;
}

type SearchSwitch = NonNullable<Schemas["ReferenceSearchStart"]["switch"]>;

/** Where zero is: found at a switch, or set here. */
export function ReferenceSection({ at, device, action, disabled }: Props) {
  const queries = useQueryClient();
  const home = can(device, "home_switch");
  const [target, setTarget] = useState<SearchSwitch>(home ? "reference" : "left");
  // What a switch means is not known of every model.
  const searches = device.about.tier === "full";
  const search = useSearch(at, searches && !disabled);
  const running = search.data?.state === "running";
  // the stage's drawing has to learn of the new zero
  const moved = () => void queries.invalidateQueries({ queryKey: ["emulator", at.device] });
  const refresh = () => void queries.invalidateQueries({ queryKey: searchKey(at) });
  return (
    <>
      {searches ? (
        <>
          <SegmentedControl
            fullWidth
            aria-label="Switch to search"
            data={[
              { value: "left", label: "Left" },
              ...(home ? [{ value: "reference", label: "Reference" }] : []),
              { value: "right", label: "Right" },
            ]}
            value={target}
            disabled={disabled || running}
            onChange={(value) => setTarget(value as SearchSwitch)}
          />
          <SearchProgress
            search={search.data}
            label="Reference search"
            idle="Finds both edges of a switch and puts zero in their middle."
            done={({ offset }) =>
              `Zero is in the middle of the edges; the count moved by ${withUnit(offset, "microsteps")}.`
            }
          />
        </>
      ) : (
        <p className="hint m-0">No search for a switch: what its switches are called is not known here.</p>
      )}
      <Group gap={6} grow wrap="nowrap">
        {searches && (
          <Button
            disabled={disabled}
            variant={running ? "default" : "filled"}
            data-testid="reference-search"
            onClick={() =>
              void action
                .run(running ? "Ending the search" : "Starting the search", () =>
                  running ? motion.endSearch(at) : motion.search(at, { switch: target }),
                )
                .then(refresh)
            }
          >
            {running ? "Abort" : "Search"}
          </Button>
        )}
        <Button
          variant="default"
          disabled={disabled || running}
          title="Calls the present position 0; the motor does not move"
          data-testid="set-zero"
          onClick={() => void action.run("Setting zero", () => setZero(at, device)).then(moved)}
        >
          Set zero here
        </Button>
      </Group>
    </>
  );
}
