import { Button, Loader, Stack, Text } from "@mantine/core";
import { IconRotate360 } from "@tabler/icons-react";
import { Link } from "wouter";
import { type Device, useDevices } from "../../api/queries";
import { EmptyState } from "../../lib/EmptyState";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { Page } from "../../lib/Section";
import { useSelection } from "../../live/selection";
import { RotaryAxis } from "./RotaryAxis";
import { useExtended } from "./useExtended";

/** Axes that turn for ever, and moves beyond what a chip can count. */
export default function RotaryPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  if (devices.data === undefined && !devices.isError) return <Waiting />;
  const entry = device?.axes.find((candidate) => candidate.index === axis);
  if (!device || !entry)
    return (
      <EmptyState title="No device" icon={<IconRotate360 size={22} />}>
        <Text size="sm" c="dimmed">
          Connect a device, or add an emulated one: that needs no hardware.
        </Text>
        <Button component={Link} href="/connections" size="sm">
          Connections
        </Button>
      </EmptyState>
    );
  const known: Device = devices.isError ? { ...device, state: "disconnected" } : device;
  return <Watched key={`${device.id}/${axis}`} device={known} axis={entry} />;
}

function Waiting() {
  return (
    <Page name="Rotary">
      <Stack align="center" py="xl">
        <Loader aria-label="Looking where the axis is" />
      </Stack>
    </Page>
  );
}

function Watched({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const connected = device.state === "connected";
  const extended = useExtended({ device: device.id, axis: axis.index }, connected);
  if (extended.seen !== null)
    return <RotaryAxis device={device} axis={axis} extended={extended} seen={extended.seen} connected={connected} />;
  if (connected && extended.query.error === null) return <Waiting />;
  return (
    <Page name="Rotary">
      <DeviceNotice device={device} />
      {connected && (
        <ProblemAlert
          error={extended.query.error}
          doing="Looking where the axis is"
          retry={() => void extended.query.refetch()}
        />
      )}
      <EmptyState title={`Nothing is known of where ${device.name} is`} icon={<IconRotate360 size={22} />}>
        <Text size="sm" c="dimmed">
          Once it is connected, its axis can be watched here beyond the range of its counter.
        </Text>
      </EmptyState>
    </Page>
  );
}
