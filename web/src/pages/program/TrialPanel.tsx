import { Button, NumberInput, Text } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { useMemo, useState } from "react";
import { api, type Schemas } from "../../api/client";
import { fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { colorOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { Plot } from "../../plots/Plot";
import type { PlotData } from "../../plots/series";
import { placeName } from "./lines";
import { bodyOf } from "./usePrograms";

type Outcome = Schemas["ProgramTrial"];

const ENDED: Readonly<Record<Outcome["ended"], string>> = {
  stopped: "It ended by itself, and the motor stands.",
  time: "It was still running when its time was over.",
  work: "It was ended: it took too much of the server's time.",
};

interface Props {
  device: string;
  name: string;
  text: string;
  labels: Readonly<Record<string, number>>;
  /** the program is right, and the module can be read */
  ready: boolean;
}

/** What the program would do: on an emulated module that is set as this one is. Nothing on the bench moves. */
export function TrialPanel({ device, name, text, labels, ready }: Props) {
  const [seconds, setSeconds] = useState(10);
  const trial = useMutation({
    mutationFn: (wanted: { text: string; duration_s: number }) =>
      api.POST("/api/v1/devices/{device}/program/try", {
        path: { device },
        body: { ...bodyOf(name, wanted.text), address: 0, duration_s: wanted.duration_s },
      }),
  });
  return (
    <div className="grid gap-8">
      <div className="row wrap gap-8 end">
        <NumberInput
          w={110}
          label="At most [s]"
          min={1}
          max={60}
          value={seconds}
          onChange={(value) => setSeconds(Math.min(60, Math.max(1, Number(value) || 1)))}
        />
        <Button
          variant="default"
          disabled={!ready}
          loading={trial.isPending}
          onClick={() => trial.mutate({ text, duration_s: seconds })}
        >
          Try on the emulator
        </Button>
      </div>
      {trial.isError && <ProblemAlert error={trial.error} doing="Trying the program" onClose={trial.reset} />}
      {trial.data ? (
        <Result outcome={trial.data} labels={labels} />
      ) : (
        <Text className="hint">
          An emulated module of its own is set as this one is and runs the program from its start, faster than real
          time. This module is only read, and nothing moves.
        </Text>
      )}
    </div>
  );
}

function Result({ outcome, labels }: { outcome: Outcome; labels: Readonly<Record<string, number>> }) {
  const scheme = useScheme();
  const data = useMemo((): PlotData => [outcome.time_s, outcome.position, outcome.velocity_pps], [outcome]);
  const series = useMemo(
    () => [
      { label: "position", color: colorOf("position", scheme), unit: "µsteps" },
      { label: "velocity", color: colorOf("velocity", scheme), unit: "pps", scale: "velocity" },
    ],
    [scheme],
  );
  const variables = Object.entries(outcome.variables)
    .map(([number, value]) => `${number}: ${value}`)
    .join(", ");
  const seconds = outcome.time_s.at(-1) ?? 0;
  return (
    <>
      <Text size="sm" role="status" data-testid="trial">
        {`${ENDED[outcome.ended]} After ${fixed(seconds, 2, "s")} it is at ${placeName(labels, outcome.counter)}, the motor at ${outcome.position.at(-1) ?? 0}; accumulator ${outcome.accumulator}, X ${outcome.x}, flags ${outcome.flags.join(", ") || "none"}; variables ${variables || "all 0"}${outcome.error ? `; a command was refused, status ${outcome.error}` : ""}.`}
      </Text>
      <Plot
        label="Trial on the emulator"
        series={series}
        data={data}
        x={{ label: "time", unit: "s" }}
        scales={{ y: { unit: "µsteps" }, velocity: { unit: "pps", side: "right", include: [0] } }}
        height={200}
        legend
        limit={[0, Math.max(seconds, 0.02)]}
      />
    </>
  );
}
