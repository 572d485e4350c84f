import { Group, Text } from "@mantine/core";
import { useDevices } from "../api/queries";
import { StateDot } from "../lib/StateDot";

/** The link to the server in two words. */
export function ServerStatus() {
  const devices = useDevices();
  const online = !devices.isError && devices.data !== undefined;
  const connected = devices.data?.filter((device) => device.state === "connected").length ?? 0;
  const total = devices.data?.length ?? 0;
  const state = online ? "connected" : devices.isError ? "failed" : "connecting";
  return (
    <Group gap={6} wrap="nowrap" visibleFrom="lg" data-testid="server-status">
      <StateDot state={state} />
      <Text size="xs" c="dimmed" style={{ whiteSpace: "nowrap" }}>
        {online ? `${connected} of ${total} connected` : devices.isError ? "server lost" : "connecting"}
      </Text>
    </Group>
  );
}
