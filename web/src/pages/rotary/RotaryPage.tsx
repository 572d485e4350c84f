import { Text } from "@mantine/core";
import { IconRotate360 } from "@tabler/icons-react";
import type { Device } from "../../api/queries";
import { EmptyState } from "../../lib/EmptyState";
import { NoDevice, Waiting } from "../../lib/NoDevice";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { useSelectedAxis } from "../../live/selection";
import { RotaryAxis } from "./RotaryAxis";
import { useExtended } from "./useExtended";

const LOOKING = "Looking where the axis is";

/** Axes that turn for ever, and moves beyond what a chip can count. */
export default function RotaryPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="Rotary" label={LOOKING} />;
  if (!device || !entry) return <NoDevice page="Rotary" icon={<IconRotate360 size={22} />} />;
  return <Watched key={key} device={device} axis={entry} />;
}

function Watched({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const connected = device.state === "connected";
  const extended = useExtended({ device: device.id, axis: axis.index }, connected);
  if (extended.seen !== null)
    return <RotaryAxis device={device} axis={axis} extended={extended} seen={extended.seen} connected={connected} />;
  if (connected && extended.query.error === null) return <Waiting page="Rotary" label={LOOKING} />;
  return (
    <Page name="Rotary">
      <DeviceNotice device={device} />
      {connected && (
        <ProblemAlert error={extended.query.error} doing={LOOKING} retry={() => void extended.query.refetch()} />
      )}
      <EmptyState title={`Nothing is known of where ${device.name} is`} icon={<IconRotate360 size={22} />}>
        <Text size="sm" c="dimmed">
          Once it is connected, its axis can be watched here beyond the range of its counter.
        </Text>
      </EmptyState>
    </Page>
  );
}
