import { Button, Text } from "@mantine/core";
import { IconRotateClockwise2 } from "@tabler/icons-react";
import { Link } from "wouter";
import { EmptyState } from "../../lib/EmptyState";
import { useSelection } from "../../live/selection";

export default function EncoderPage() {
  const { device } = useSelection();
  return (
    <>
      <h1 style={{ fontSize: "1.1rem", margin: 0 }}>Encoder</h1>
      <EmptyState
        title={device ? `No encoder values of ${device.name} yet` : "No device"}
        icon={<IconRotateClockwise2 size={22} />}
      >
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
