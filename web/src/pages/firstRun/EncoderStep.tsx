import { Button, Group, Text } from "@mantine/core";
import { useState } from "react";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { StudyView } from "../tune/StudyView";
import { useChanges, useStudies } from "../tune/useStudies";
import type { StepProps } from "./StepProps";
import { Term } from "./Term";

/** A first look: whether there is an encoder, which way it counts, and how many lines it has. */
export function EncoderStep({ device, axis, onDone, disabled }: StepProps) {
  const studies = useStudies();
  const [begun, setBegun] = useState<string | null>(null);
  const changes = useChanges(setBegun);
  const own = studies.data?.studies.find(
    (study) => study.device === device.id && study.axis === axis.index && study.kind === "first_look",
  );
  const shown = begun ?? own?.id ?? null;
  const wish = { device: device.id, axis: axis.index, study: { kind: "first_look" as const } };
  return (
    <>
      <Text size="sm">
        An <Term name="encoder">encoder</Term> at the shaft tells how far it really went. The study turns the motor one
        turn to either side, and finds its resolution and direction; what it would set right is a button.
      </Text>
      {changes.start.error && (
        <ProblemAlert error={changes.start.error} doing="Beginning the study" onClose={() => changes.start.reset()} />
      )}
      <Group gap="xs" my="sm">
        <Button disabled={disabled} loading={changes.start.isPending} onClick={() => changes.start.mutate(wish)}>
          Look (moves)
        </Button>
        <Button variant="default" onClick={() => onDone()}>
          {shown === null ? "There is none" : "Go on"}
        </Button>
      </Group>
      {shown !== null && <StudyView id={shown} changes={changes} />}
    </>
  );
}
