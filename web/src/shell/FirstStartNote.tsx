import { Alert, Progress, Text } from "@mantine/core";
import { IconCpu } from "@tabler/icons-react";

/** How far a first start is, and what works meanwhile. */
export function FirstStartNote({ done, total }: { done: number; total: number }) {
  return (
    <Alert
      role="status"
      p="sm"
      mb="sm"
      icon={<IconCpu size={20} aria-hidden />}
      title="First start: emulators are made ready for this machine"
      data-testid="first-start"
    >
      <Text size="sm" mb="xs">
        {done} of {total} are there, the rest within a minute or two. All devices work already; until then emulated
        motors may move slower than real ones, and studies of them wait. The next start takes seconds.
      </Text>
      <Progress value={(done / total) * 100} animated aria-label={`${done} of ${total} made ready`} />
    </Alert>
  );
}
