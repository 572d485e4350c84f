import { Button, Group, Text } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas } from "../../api/client";
import { can } from "../../api/queries";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { StartUpPlan } from "../../lib/startup/StartUpPlan";
import { figuresOf } from "./motorFigures";
import type { StepProps } from "./StepProps";
import { turnsBy } from "./steps";
import { Term } from "./Term";

type Profile = Schemas["ProfileDocument"];

/** Currents, microsteps and a slow ramp for the motor, all or nothing, and the way back. */
export function SetUpStep({ device, axis, progress, onDone, disabled }: StepProps) {
  const queries = useQueryClient();
  const [was, setWas] = useState<Profile | null>(null);
  /** counts the ways back: each time it is planned anew */
  const [round, setRound] = useState(0);
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
        <Term name="microstep">microsteps</Term>
        {turnsBy(device) === "position" ? (
          <>
            , and a <Term name="ramp">ramp</Term> that every motor can do, a turn a second.
          </>
        ) : (
          ". It has no ramp: that is made by whoever steps it."
        )}
      </Text>
      {(!can(device, "current") || can(device, "current.ramp")) && (
        <Text size="sm" mb="xs">
          The current is not set here but at the driver behind, by its trimmer or its own registers: set it to the rated
          current first, then go on.
        </Text>
      )}
      <StartUpPlan
        key={round}
        device={device.id}
        body={{ axes: [axis.index], motor: figuresOf(progress) }}
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
