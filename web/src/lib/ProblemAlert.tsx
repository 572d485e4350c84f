import { Alert, Button, Group, Text } from "@mantine/core";
import { IconAlertTriangle } from "@tabler/icons-react";
import { problemOf } from "../api/client";

interface Props {
  /** whatever a failed call gave: an ApiError, a problem+json, an Error */
  error: unknown;
  /** what was tried, in the user's words: "Moving axis x" */
  doing?: string;
  retry?: () => void;
  onClose?: () => void;
}

/** An error, complete: what failed, why, and the way out. */
export function ProblemAlert({ error, doing, retry, onClose }: Props) {
  if (error === null || error === undefined) return null;
  const problem = problemOf(error);
  return (
    <Alert
      color="red"
      variant="light"
      role="alert"
      p="sm"
      icon={<IconAlertTriangle size={18} aria-hidden />}
      title={doing ? `${doing}: ${problem.title}` : problem.title}
      withCloseButton={onClose !== undefined}
      closeButtonLabel="Dismiss"
      {...(onClose ? { onClose } : {})}
    >
      <Text size="sm">{problem.detail}</Text>
      {problem.way_out && (
        <Text size="sm" fw={600} mt={4}>
          {problem.way_out}
        </Text>
      )}
      {retry && (
        <Group mt="xs">
          <Button size="compact-sm" variant="default" onClick={retry}>
            Try again
          </Button>
        </Group>
      )}
    </Alert>
  );
}
