import { Button, Group, Text } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas } from "../../api/client";
import { compact } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useWork } from "../../lib/useWork";
import classes from "./firstRun.module.css";
import type { StepProps } from "./StepProps";
import { Term } from "./Term";

const FASTEST_RPS = 5;
const SHARPEST_RPS2 = 50;

/** What the axis may never go beyond, whoever asks: before anything moves. */
export function LimitsStep({ device, axis, progress, onDone, disabled }: StepProps) {
  const queries = useQueryClient();
  const turn = axis.full_steps_per_rev * (axis.microsteps_per_full_step ?? axis.driver_microsteps);
  const [fastest, setFastest] = useState<number | null>(
    axis.limits.velocity_max_pps == null ? FASTEST_RPS : axis.limits.velocity_max_pps / turn,
  );
  const [sharpest, setSharpest] = useState<number | null>(
    axis.limits.acceleration_max_pps2 == null ? SHARPEST_RPS2 : axis.limits.acceleration_max_pps2 / turn,
  );
  const work = useWork(
    () => {
      const velocity = fastest === null ? null : fastest * turn;
      const acceleration = sharpest === null ? null : sharpest * turn;
      const axes = device.axes.map((each) => {
        const { name, full_steps_per_rev, driver_microsteps, gear_ratio, travel_mm_per_rev } = each;
        const { lost_steps_microsteps, following_error_microsteps } = each;
        const kept = {
          name,
          driver_microsteps,
          gear_ratio,
          travel_mm_per_rev,
          lost_steps_microsteps,
          following_error_microsteps,
        };
        if (each.index !== axis.index) return { ...kept, full_steps_per_rev, limits: each.limits };
        const limits = { ...each.limits, velocity_max_pps: velocity, acceleration_max_pps2: acceleration };
        return { ...kept, full_steps_per_rev: progress.motor?.fullStepsPerRev ?? full_steps_per_rev, limits };
      });
      return api.PATCH("/api/v1/devices/{device}", {
        path: { device: device.id },
        body: { axes } as Schemas["DeviceChange"],
      });
    },
    {
      onSuccess: () => onDone(),
      onSettled: () => queries.invalidateQueries({ queryKey: ["devices"] }),
    },
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
        <NumberField
          label="Sharpest"
          unit="rev_per_s2"
          min={0.1}
          max={100_000}
          value={sharpest}
          onChange={setSharpest}
          onClear={() => setSharpest(null)}
        />
      </div>
      <Group gap="xs" my="sm">
        <Button loading={work.isPending} disabled={disabled} onClick={work.mutate}>
          Set these limits
        </Button>
        <Button variant="default" onClick={() => onDone()}>
          Leave as it is
        </Button>
      </Group>
      <Text size="sm" className="dim">
        {fastest === null ? "No limit of speed" : `${compact(fastest * turn)} microsteps a second`},{" "}
        {sharpest === null ? "none of acceleration" : `${compact(sharpest * turn)} microsteps a second squared`},
        counted with {axis.microsteps_per_full_step ?? axis.driver_microsteps} microsteps a full step.
      </Text>
      {work.error && <ProblemAlert error={work.error} doing="Setting the limits" onClose={work.reset} />}
    </>
  );
}
