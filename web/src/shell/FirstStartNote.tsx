import { Alert, Progress, Text } from "@mantine/core";
import { IconCpu } from "@tabler/icons-react";

/** How far a first start is, and what works meanwhile; a phone has no room for more than the first line. */
export function FirstStartNote({ done, total }: { done: number; total: number }) {
  return (
    <Alert role="status" p="xs" mb="sm" icon={<IconCpu size={20} aria-hidden />} data-testid="first-start">
      <Text size="sm">
        <b>First start:</b> {done} of {total} emulators are made ready for this machine.
      </Text>
      <Text size="sm" visibleFrom="sm">
        All devices work already; until then emulated motors may move slower than real ones, and studies of them wait.
      </Text>
      <Progress mt={6} size="sm" value={(done / total) * 100} animated aria-label={`${done} of ${total} made ready`} />
    </Alert>
  );
}
