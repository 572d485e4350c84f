import { Button, Group, Text } from "@mantine/core";
import { useState } from "react";
import { compact, exactText } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { draftOf } from "../connections/draft";
import { useSaveDevice } from "../connections/useConnections";
import classes from "./firstRun.module.css";
import type { StepProps } from "./StepProps";
import { turnsBy } from "./steps";
import { Term } from "./Term";

const FASTEST_RPS = 5;
const SHARPEST_RPS2 = 50;

/** What the axis may never go beyond, whoever asks: before anything moves. */
export function LimitsStep({ device, axis, progress, onDone, disabled }: StepProps) {
  const turn = axis.full_steps_per_rev * (axis.microsteps_per_full_step ?? axis.driver_microsteps);
  const [fastest, setFastest] = useState<number | null>(
    axis.limits.velocity_max_pps == null ? FASTEST_RPS : axis.limits.velocity_max_pps / turn,
  );
  const [sharpest, setSharpest] = useState<number | null>(
    axis.limits.acceleration_max_pps2 == null ? SHARPEST_RPS2 : axis.limits.acceleration_max_pps2 / turn,
  );
  const ramped = turnsBy(device) === "position";
  const before = draftOf(device);
  const save = useSaveDevice({ device, before });
  const own = {
    full_steps_per_rev: exactText(progress.motor?.fullStepsPerRev ?? axis.full_steps_per_rev),
    "limits.velocity_max_pps": fastest === null ? "" : exactText(fastest * turn),
    // what has no ramp jumps to its speed: such a limit would forbid that it ever moves
    ...(ramped && { "limits.acceleration_max_pps2": sharpest === null ? "" : exactText(sharpest * turn) }),
  };
  const axes = before.axes.map((values, row) =>
    device.axes[row]?.index === axis.index ? { ...values, ...own } : values,
  );
  return (
    <>
      <Text size="sm">
        A <Term name="soft-limit">soft limit</Term> holds on every path: pages, scripts, studies. Begin low, and raise
        it later on the page Connections, where the ends of the travel are set, too.
      </Text>
      <div className={classes.fields}>
        <NumberField
          label="Fastest"
          unit="rev_per_s"
          min={0.01}
          max={1000}
          value={fastest}
          onChange={setFastest}
          onClear={() => setFastest(null)}
        />
        {ramped && (
          <NumberField
            label="Sharpest"
            unit="rev_per_s2"
            min={0.1}
            max={100_000}
            value={sharpest}
            onChange={setSharpest}
            onClear={() => setSharpest(null)}
          />
        )}
      </div>
      <Group gap="xs" my="sm">
        <Button
          loading={save.isPending}
          disabled={disabled}
          onClick={() => save.mutate({ ...before, axes }, { onSuccess: () => onDone() })}
        >
          Set these limits
        </Button>
        <Button variant="default" onClick={() => onDone()}>
          Leave as it is
        </Button>
      </Group>
      <Text size="sm" className="dim">
        {fastest === null ? "No limit of speed" : `${compact(fastest * turn)} microsteps a second`},{" "}
        {!ramped
          ? "and none of acceleration, as it has no ramp of its own"
          : sharpest === null
            ? "none of acceleration"
            : `${compact(sharpest * turn)} microsteps a second squared`}
        , counted with {axis.microsteps_per_full_step ?? axis.driver_microsteps} microsteps a full step.
      </Text>
      {save.error && <ProblemAlert error={save.error} doing="Setting the limits" onClose={save.reset} />}
    </>
  );
}
