import { Button, Group, Text } from "@mantine/core";
import type { Study } from "../study";
import type { StallFound } from "./rates";

interface Props {
  study: Study;
  found: StallFound;
  /** with the number of the trial */
  onTake: (trial: number) => void;
  busy: boolean;
}

/** Takes a threshold that is proved at one speed; nothing where there is none, or the study runs. */
export function TakeOwn({ study, found, onTake, busy }: Props) {
  const owns = found.speeds.flatMap(({ own, speed_rps: speed }) => (own ? [{ ...own, speed }] : []));
  if (study.state === "running" || owns.length === 0) return null;
  const taken = owns.find(({ trial }) => trial === study.taken?.trial);
  return (
    <Group gap="xs" mt="xs">
      {owns.map(({ trial, speed }) => (
        <Button key={trial} size="compact-sm" variant="default" disabled={busy} onClick={() => onTake(trial)}>
          Take that of {speed} turns/s
        </Button>
      ))}
      {taken && (
        <Text size="sm" role="status">
          Taken: that of {taken.speed} turns/s.
        </Text>
      )}
    </Group>
  );
}
