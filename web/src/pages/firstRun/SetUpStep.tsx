import { Button, Group, Text } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas } from "../../api/client";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { StartUpPlan } from "../../lib/startup/StartUpPlan";
import type { StepProps } from "./StepProps";
import { Term } from "./Term";

type Profile = Schemas["ProfileDocument"];

/** Currents, microsteps and a slow ramp for the motor, all or nothing, and the way back. */
export function SetUpStep({ device, axis, progress, onDone, disabled }: StepProps) {
  const queries = useQueryClient();
  const [was, setWas] = useState<Profile | null>(null);
  /** counts the ways back: each time it is planned anew */
  const [round, setRound] = useState(0);
  const { motor } = progress;
  const figures =
    motor === null
      ? null
      : {
          full_steps_per_rev: motor.fullStepsPerRev,
          rated_current_a: motor.ratedCurrentA,
          sense_resistor_ohm: motor.senseResistorOhm,
          current_full_scale_a: motor.fullScaleA,
        };
  const path = { path: { device: device.id } };
  const back = useMutation({
    mutationFn: (profile: Profile) =>
      api.PUT("/api/v1/devices/{device}/profile", { ...path, body: profile as Schemas["ProfileIn"] }),
    onSuccess: () => {
      setWas(null);
      setRound((now) => now + 1);
    },
    onSettled: () => queries.invalidateQueries(),
  });
  return (
    <>
      <Text size="sm" mb="xs">
        What is to be written so that the axis can move: its current in motion and at rest,{" "}
        <Term name="microstep">microsteps</Term>, and a <Term name="ramp">ramp</Term> that every motor can do, a turn a
        second.
      </Text>
      <StartUpPlan
        key={round}
        device={device.id}
        body={{ axes: [axis.index], motor: figures }}
        axisNames={device.axes.map(({ name }) => name)}
        disabled={disabled}
        before={async () => setWas(await api.GET("/api/v1/devices/{device}/profile", path))}
      >
        {was && (
          <Button size="sm" variant="default" loading={back.isPending} onClick={() => back.mutate(was)}>
            Put back what was before
          </Button>
        )}
      </StartUpPlan>
      {back.error && <ProblemAlert error={back.error} doing="Putting it back" onClose={() => back.reset()} />}
      <Group gap="xs" mt="sm">
        <Button variant={was ? "filled" : "default"} onClick={() => onDone()}>
          Go on
        </Button>
      </Group>
    </>
  );
}
