import { Alert, Button, Group, Text } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { Link } from "wouter";
import { api } from "../../api/client";
import { type Device, useDevices } from "../../api/queries";
import { ProblemAlert } from "../ProblemAlert";

/** Why the values stand still, and what to do about it. Nothing while the device is connected, or left alone. */
export function DeviceNotice({ device }: { device: Device }) {
  const queries = useQueryClient();
  const connect = useMutation({
    mutationFn: () => api.POST("/api/v1/devices/{device}/connect", { path: { device: device.id } }),
    onSettled: () => queries.invalidateQueries({ queryKey: ["devices"] }),
  });
  const devices = useDevices();
  // a server that is gone, and what is held back, are told of above every page
  if (device.state === "connected" || device.heldBack || devices.isError) return null;
  if (device.state === "connecting") return <Alert p="xs">Connecting to {device.name}…</Alert>;
  if (device.problem) return <ProblemAlert error={device.problem} doing={device.name} retry={() => connect.mutate()} />;
  return (
    <Alert p="xs" role="status">
      <Group gap="sm">
        <Text size="sm">{device.name} is not connected. Edits can be staged now and applied later.</Text>
        <Button size="compact-sm" loading={connect.isPending} onClick={() => connect.mutate()}>
          Connect
        </Button>
        <Button size="compact-sm" variant="default" component={Link} href="/connections">
          Connections
        </Button>
      </Group>
      {connect.isError && <ProblemAlert error={connect.error} doing="Connecting" />}
    </Alert>
  );
}
