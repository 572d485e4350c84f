import { Button, Group, Text } from "@mantine/core";
import { ProblemAlert } from "../../lib/ProblemAlert";
import type { Parameters } from "./useParameters";

/** Applies what is staged; says what came back where that is something else. Its height is there from the start. */
export function StagedBar({ parameters, disabled }: { parameters: Parameters; disabled: boolean }) {
  const { staged, notes, error } = parameters;
  const count = staged.size;
  return (
    <>
      <Group gap={6} wrap="nowrap" justify="space-between" mih={30}>
        <Text size="xs" c="dimmed" role="status">
          {count === 0 ? "No changes" : `${count} not applied`}
        </Text>
        <Group gap={6} wrap="nowrap">
          <Button size="compact-xs" variant="default" disabled={count === 0} onClick={parameters.discard}>
            Discard
          </Button>
          <Button
            size="compact-xs"
            disabled={disabled || count === 0}
            loading={parameters.applying}
            onClick={parameters.apply}
            data-testid="apply"
          >
            Apply
          </Button>
        </Group>
      </Group>
      {notes.map((note) => (
        <Text key={note} size="xs" role="status">
          {note}
        </Text>
      ))}
      {error && <ProblemAlert error={error} doing="Parameters" onClose={parameters.dismiss} />}
    </>
  );
}
