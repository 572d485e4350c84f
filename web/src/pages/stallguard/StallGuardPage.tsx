import { Button, Text } from "@mantine/core";
import { IconGauge } from "@tabler/icons-react";
import { Link } from "wouter";
import { EmptyState } from "../../lib/EmptyState";
import { useSelection } from "../../live/selection";

export default function StallGuardPage() {
  const { device } = useSelection();
  return (
    <>
      <h1 style={{ fontSize: "1.1rem", margin: 0 }}>StallGuard</h1>
      <EmptyState title={device ? `No load values of ${device.name} yet` : "No device"} icon={<IconGauge size={22} />}>
        <Text size="sm" c="dimmed">
          Connect a module, or add an emulated one: that needs no hardware.
        </Text>
        <Button component={Link} href="/connections" size="sm">
          Connections
        </Button>
      </EmptyState>
    </>
  );
}
