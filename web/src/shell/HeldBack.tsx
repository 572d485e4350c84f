import { Alert, Button, Group, Text } from "@mantine/core";
import { IconPlayerPause } from "@tabler/icons-react";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { Link } from "wouter";
import { api, unwrap } from "../api/client";
import { type Device, useDevices } from "../api/queries";
import { inDownloadMode, modelsFound } from "../lib/heldBack";
import { ProblemAlert } from "../lib/ProblemAlert";

/** Above every page: devices that are left alone although they answer, why, and the way out as a button. */
export function HeldBack() {
  const devices = useDevices();
  const held = devices.data?.filter((device) => inDownloadMode(device) || modelsFound(device) !== null) ?? [];
  return held.map((device) => <Held key={device.id} device={device} />);
}

function Held({ device }: { device: Device }) {
  const queries = useQueryClient();
  const params = { params: { path: { device: device.id } } };
  const onSettled = () => queries.invalidateQueries({ queryKey: ["devices"] });
  const leave = useMutation({
    mutationFn: async () =>
      unwrap(
        await api.POST("/api/v1/devices/{device}/tmcl", {
          ...params,
          body: { command: 133, type: 0, motor: 0, value: 0 },
        }),
      ),
    onSettled,
  });
  const change = useMutation({
    mutationFn: async (model: Device["model"]) =>
      unwrap(await api.PATCH("/api/v1/devices/{device}", { ...params, body: { model } })),
    onSettled,
  });
  const failed = leave.error ?? change.error;
  return (
    <Alert
      color="orange"
      variant="light"
      role="alert"
      p="sm"
      mb="sm"
      icon={<IconPlayerPause size={20} aria-hidden />}
      styles={{ label: { color: "var(--mantine-color-text)" } }} // the orange of the library is too faint on its light ground
      title={`${device.name}: ${device.problem?.title ?? ""}`}
      data-testid="held-back"
    >
      <Text size="sm">{device.problem?.detail}</Text>
      <Group mt="xs" gap="sm">
        {inDownloadMode(device) && (
          <Button size="compact-sm" loading={leave.isPending} onClick={() => leave.mutate()}>
            Leave download mode
          </Button>
        )}
        {modelsFound(device)?.map((model) => (
          <Button key={model} size="compact-sm" loading={change.isPending} onClick={() => change.mutate(model)}>
            Change the model to {model.toUpperCase()}
          </Button>
        ))}
        <Button size="compact-sm" variant="default" component={Link} href="/connections">
          Connections
        </Button>
      </Group>
      {failed && <ProblemAlert error={failed} doing={inDownloadMode(device) ? "Leaving" : "Changing the model"} />}
    </Alert>
  );
}
