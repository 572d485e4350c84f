import { Button, Group, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { api } from "../../api/client";
import { ProblemAlert } from "../../lib/ProblemAlert";
import type { Action } from "../bench/motion/useAction";
import { flagAmong } from "./flags";

interface Props {
  device: string;
  axis: number;
  /** names of fields and parameters that do it, of which a device has one at most */
  names: readonly string[];
  action: Action;
  /** what the other value does, and the button for it */
  does: string;
  label: string;
  doing: string;
  /** what to do where the device has none */
  otherwise: string;
}

/** A setting of one bit that puts something right: what it holds, and a button for its other value. */
export function SettingButton({ device, axis, names, action, does, label, doing, otherwise }: Props) {
  const rows = useQuery({
    queryKey: ["registers", device, axis, names.join()],
    queryFn: () => api.GET("/api/v1/devices/{device}/registers", { path: { device } }),
    retry: false,
  });
  if (rows.error)
    return <ProblemAlert error={rows.error} doing="Reading the registers" retry={() => void rows.refetch()} />;
  if (rows.data === undefined)
    return (
      <Text size="sm" mt="xs" role="status">
        Looking for a setting that does it
      </Text>
    );
  const found = flagAmong(
    rows.data.filter((row) => row.axis === null || row.axis === axis),
    names,
  );
  if (found === null)
    return (
      <Text size="sm" mt="xs" role="status">
        No setting of this device does it: {otherwise}
      </Text>
    );
  const change = async () => {
    await api.PUT("/api/v1/devices/{device}/registers/{name}", {
      path: { device, name: found.register },
      query: { axis },
      body: found.field === null ? { value: found.other } : { fields: { [found.field]: found.other } },
    });
    await rows.refetch();
  };
  return (
    <Group gap="xs" mt="xs">
      <Text size="sm">
        <code>{found.field ?? found.register}</code> is {found.value}: {does}
      </Text>
      <Button size="compact-sm" loading={action.busy} onClick={() => void action.run(doing, change)}>
        {label}
      </Button>
    </Group>
  );
}
