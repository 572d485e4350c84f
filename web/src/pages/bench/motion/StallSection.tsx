import { Button, Group, SegmentedControl } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import type { Schemas } from "../../../api/client";
import { type AxisAddress, motion } from "../../../api/motion";
import { optionsOf } from "../../../lib/choices";
import { NumberField } from "../../../lib/NumberField";
import classes from "../bench.module.css";
import { SearchProgress } from "./SearchProgress";
import { type SearchStep, SearchSteps } from "./SearchSteps";
import type { Action } from "./useAction";
import { searchKey, useSearch } from "./useSearch";

interface Props {
  at: AxisAddress;
  action: Action;
  disabled: boolean;
}

type Stall = NonNullable<Schemas["ReferenceSearchStart"]["stall"]>;

const SPEED_MAX = 7_999_774;

/** What it is going to do; the back-off lies between two hits. */
function stepsOf({ side, hits }: Stall): SearchStep[] {
  const away = side === "left" ? "right" : "left";
  const again = (hits ?? 3) - 1;
  return [
    { to: away, fast: true, until: "StallGuard was seen to work at that speed" },
    { to: side, fast: true, until: "the motor stalls at the end" },
    ...(again > 0
      ? [
          { to: away, fast: true, until: "it is up to speed on its way back" } as const,
          {
            to: side,
            fast: true,
            until: again === 1 ? "it stalls again" : `it stalls again; this and the way back ${again} times`,
          } as const,
        ]
      : []),
    { to: "zero", fast: true, until: "it stands where the rotor met the end" },
  ];
}

/** Zero at the end of the stage, found without a switch: by the stall that the driver measures. */
export function StallSection({ at, action, disabled }: Props) {
  const queries = useQueryClient();
  const search = useSearch(at, !disabled);
  const [wanted, setWanted] = useState<Stall>({ side: "left", hits: 3 });
  const running = search.data?.state === "running";
  const locked = disabled || running;
  const field = (
    label: string,
    key: "velocity" | "threshold" | "current_percent" | "hits",
    unit: string,
    [min, max, step]: [number, number, number],
    otherwise: string,
  ) => (
    <NumberField
      classNames={{ root: classes.inline, input: "num" }}
      label={label}
      value={wanted[key] ?? null}
      placeholder={otherwise}
      unit={unit}
      min={min}
      max={max}
      step={step}
      disabled={locked}
      onChange={(next) => setWanted((now) => ({ ...now, [key]: key === "hits" ? (next ?? 3) : next }))}
      data-testid={`stall-${key}`}
    />
  );
  return (
    <>
      <SegmentedControl
        fullWidth
        aria-label="End of the stage to search"
        data={optionsOf({ left: "Left end", right: "Right end" })}
        value={wanted.side}
        disabled={locked}
        onChange={(side) => setWanted((now) => ({ ...now, side: side as Stall["side"] }))}
      />
      {field("Speed", "velocity", "pps", [1, SPEED_MAX, 1000], "a turn a second")}
      {field("Threshold", "threshold", "", [-64, 63, 1], "found by itself")}
      {field("Current", "current_percent", "%", [1, 100, 5], "as it is set")}
      {field("Hits", "hits", "", [1, 10, 1], "3")}
      <SearchSteps steps={stepsOf(wanted)} />
      <SearchProgress
        search={search.data}
        label="Search by stall"
        testId="stall-state"
        idle="It asks for no switch: the load that StallGuard measures tells the end."
        running={({ phase, edges }) => (edges.length > 0 ? `${phase}; ${edges.length} hits so far` : phase)}
      />
      <Group gap={6} grow wrap="nowrap">
        <Button
          disabled={disabled}
          variant={running ? "default" : "filled"}
          data-testid="stall-search"
          onClick={() =>
            void action
              .run(running ? "Ending the search" : "Starting the search", () =>
                running
                  ? motion.endSearch(at)
                  : motion.search(at, { stall: wanted } as Schemas["ReferenceSearchStart"]),
              )
              .then(() => {
                void queries.invalidateQueries({ queryKey: searchKey(at) });
                void queries.invalidateQueries({ queryKey: ["emulator", at.device] });
              })
          }
        >
          {running ? "Abort" : "Run against the end"}
        </Button>
      </Group>
    </>
  );
}
