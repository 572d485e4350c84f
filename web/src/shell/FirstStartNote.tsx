import { Text } from "@mantine/core";
import { IconCpu } from "@tabler/icons-react";

/**
 * How far a first start is, and what works meanwhile; a phone has no room for more than the first line. A first visit
 * sees it: its bar needs no style that is not there yet.
 */
export function FirstStartNote({ done, total }: { done: number; total: number }) {
  const percent = Math.round((done / total) * 100);
  const background = `linear-gradient(90deg, var(--accent) ${percent}%, var(--line) 0)`;
  return (
    <div role="status" className="row gap-8 pad mb-8" data-testid="first-start">
      <IconCpu size={20} className="accent" aria-hidden />
      <div className="grow">
        <Text size="sm">
          <b>First start:</b> {done} of {total} emulators are made ready for this machine.
        </Text>
        <Text size="sm" visibleFrom="sm">
          All devices work already; until then emulated motors may move slower than real ones, and studies of them wait.
        </Text>
        <div
          role="progressbar"
          aria-label={`${done} of ${total} made ready`}
          aria-valuenow={percent}
          className="mt-4"
          style={{ height: 5, borderRadius: 3, background }}
        />
      </div>
    </div>
  );
}
