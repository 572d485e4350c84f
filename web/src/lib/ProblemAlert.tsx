import { Alert, Button, Group, Text } from "@mantine/core";
import { IconAlertTriangle, IconEye } from "@tabler/icons-react";
import { problemOf } from "../api/client";
import { ONLY_LOOKING } from "../api/lease/gate";
import { NO_ANSWER } from "../api/problem";
import { Remedies } from "./Remedies";

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
  // the user has said no to the question for the bench: no fault, and no red
  const wanted = problem.type === ONLY_LOOKING;
  const title = doing ? `${doing}: ${problem.title}` : problem.title;
  const close = {
    withCloseButton: onClose !== undefined,
    closeButtonLabel: "Dismiss",
    ...(onClose ? { onClose } : {}),
  };
  const again = retry && (
    <Button size="compact-sm" variant="default" onClick={retry}>
      Try again
    </Button>
  );
  if (problem.type === NO_ANSWER)
    // what that means, and what to do, is said above every page
    return (
      <Alert color="gray" role="status" p="xs" {...close}>
        <Group gap="sm">
          <Text size="sm">{title}</Text>
          {again}
        </Group>
      </Alert>
    );
  return (
    <Alert
      color={wanted ? "gray" : "red"}
      role={wanted ? "status" : "alert"}
      p="sm"
      icon={wanted ? <IconEye size={18} aria-hidden /> : <IconAlertTriangle size={18} aria-hidden />}
      title={title}
      {...close}
    >
      <Text size="sm">{problem.detail}</Text>
      {problem.way_out && (
        <Text size="sm" fw={600} mt={4}>
          {problem.way_out}
        </Text>
      )}
      <Remedies remedies={problem.remedies} onDone={onClose} />
      {again && <Group mt="xs">{again}</Group>}
    </Alert>
  );
}
