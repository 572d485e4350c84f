import { Button, Group, Text } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../../api/client";
import { type AxisAddress, motion } from "../../../api/motion";
import { NumberField } from "../../../lib/NumberField";
import { type AxisScale, fromSteps, toSteps } from "../../../lib/units";
import classes from "../bench.module.css";
import type { LiveAxis } from "../live";
import type { Action } from "./useAction";

interface Props {
  at: AxisAddress;
  scale: AxisScale;
  unit: string;
  live: LiveAxis;
  action: Action;
  disabled: boolean;
}

export const shuttleKey = (at: AxisAddress) => ["shuttle", at.device, at.axis];

/** Back and forth between two positions until stopped: something to look at while ramps are tuned. */
export function ShuttleSection({ at, scale, unit, live, action, disabled }: Props) {
  const queries = useQueryClient();
  const turn = toSteps(1, "rev", scale, "position") || 12_800;
  const [ends, setEnds] = useState<[number, number]>([0, Math.round(4 * turn)]);
  const [dwellS, setDwellS] = useState(0.3);
  const [wrong, setWrong] = useState<Record<string, boolean>>({});
  const refused = (name: string) => (is: boolean) => setWrong((old) => ({ ...old, [name]: is }));
  const shuttle = useQuery({
    queryKey: shuttleKey(at),
    queryFn: () => api.GET("/api/v1/devices/{device}/axes/{axis}/shuttle", { path: at }),
    enabled: !disabled,
    refetchInterval: 1000,
  });
  const running = shuttle.data?.running === true;
  // While one runs, the fields say what it does, whoever has started it.
  const shown = running ? ([shuttle.data?.first ?? ends[0], shuttle.data?.second ?? ends[1]] as const) : ends;
  const refresh = () => void queries.invalidateQueries({ queryKey: ["shuttle"] });
  const end = (index: 0 | 1, label: string) => (
    <Group gap={6} wrap="nowrap" align="flex-start">
      <NumberField
        classNames={{ root: classes.inline, input: "num" }}
        label={label}
        value={fromSteps(shown[index], unit, scale, "position")}
        unit={unit}
        flex={1}
        disabled={disabled || running}
        onChange={(value) => {
          const steps = Math.round(toSteps(value, unit, scale, "position"));
          setEnds(index === 0 ? [steps, ends[1]] : [ends[0], steps]);
        }}
        onWrong={refused(label)}
      />
      <Button
        variant="default"
        w={76}
        disabled={disabled || running}
        onClick={() => {
          const here = live.read("position");
          if (!Number.isNaN(here)) setEnds(index === 0 ? [here, ends[1]] : [ends[0], here]);
        }}
      >
        Here
      </Button>
    </Group>
  );
  return (
    <>
      {end(0, "From A")}
      {end(1, "To B")}
      <Group gap={6} wrap="nowrap" align="flex-start">
        <NumberField
          classNames={{ root: classes.inline, input: "num" }}
          label="Rest"
          value={running ? (shuttle.data?.dwell_s ?? dwellS) : dwellS}
          unit="s"
          min={0}
          max={60}
          step={0.1}
          flex={1}
          disabled={disabled || running}
          onChange={setDwellS}
          onWrong={refused("Rest")}
        />
        <Button
          w={76}
          variant={running ? "default" : "filled"}
          disabled={disabled || (!running && Object.values(wrong).some(Boolean))}
          data-testid="shuttle-toggle"
          onClick={() =>
            void action
              .run(running ? "Ending the shuttle" : "Starting the shuttle", () =>
                running
                  ? motion.endShuttle(at)
                  : motion.shuttle(at, { first: ends[0], second: ends[1], dwell_s: dwellS }),
              )
              .then(refresh)
          }
        >
          {running ? "End" : "Start"}
        </Button>
      </Group>
      <Text size="xs" c="dimmed" mih={18}>
        {running ? `Running: ${shuttle.data?.cycles ?? 0} × there and back` : (shuttle.data?.message ?? "")}
      </Text>
    </>
  );
}
