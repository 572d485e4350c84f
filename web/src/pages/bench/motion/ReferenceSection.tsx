import { Button, Group, Progress, SegmentedControl, Text } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import type { Schemas } from "../../../api/client";
import { type AxisAddress, motion } from "../../../api/motion";
import { can, type Device } from "../../../api/queries";
import { withUnit } from "../../../lib/format";
import type { LiveAxis } from "../live";
import { setZero } from "./setZero";
import type { Action } from "./useAction";
import { searchKey, useSearch } from "./useSearch";

interface Props {
  at: AxisAddress;
  device: Device;
  live: LiveAxis;
  action: Action;
  disabled: boolean;
}

type SearchSwitch = NonNullable<Schemas["ReferenceSearchStart"]["switch"]>;

function outcome(search: Schemas["ReferenceSearchState"] | undefined): string {
  if (search === undefined) return "";
  switch (search.state) {
    case "idle":
      return "Finds both edges of a switch and puts zero in their middle.";
    case "running":
      return search.phase;
    case "done":
      return `Zero is in the middle of the edges; the count moved by ${withUnit(search.offset, "microsteps")}.`;
    default:
      return search.message || `The search was ${search.state}.`;
  }
}

/** Where zero is: found at a switch, or set here. */
export function ReferenceSection({ at, device, live, action, disabled }: Props) {
  const queries = useQueryClient();
  const home = can(device, "home_switch");
  const [target, setTarget] = useState<SearchSwitch>(home ? "reference" : "left");
  const search = useSearch(at, !disabled);
  const running = search.data?.state === "running";
  // the stage's drawing has to learn of the new zero
  const moved = () => void queries.invalidateQueries({ queryKey: ["emulator", at.device] });
  const refresh = () => void queries.invalidateQueries({ queryKey: searchKey(at) });
  return (
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
      <Progress
        value={100 * (search.data?.progress ?? 0)}
        size={6}
        color={search.data?.state === "failed" ? "red" : "accent"}
        aria-label="Reference search"
      />
      <Text size="xs" c={search.data?.state === "failed" ? "red" : "dimmed"} mih={36} role="status">
        {outcome(search.data)}
      </Text>
      <Group gap={6} grow wrap="nowrap">
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
        <Button
          variant="default"
          disabled={disabled || running}
          title="Calls the present position 0; the motor does not move"
          data-testid="set-zero"
          onClick={() => void action.run("Setting zero", () => setZero(at, device, live.moving())).then(moved)}
        >
          Set zero here
        </Button>
      </Group>
    </>
  );
}
