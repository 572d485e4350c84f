import { Button, Group, Text } from "@mantine/core";
import { IconPlus } from "@tabler/icons-react";
import { useQueryClient } from "@tanstack/react-query";
import { api, type Schemas, unwrap } from "../../api/client";
import type { Device } from "../../api/queries";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useSelection } from "../../live/selection";
import { useCatalog, usePorts } from "../connections/useConnections";
import { useAction } from "./motion/useAction";

type Model = Schemas["DeviceCreate"]["model"];

/** The demo has two of the families: one click brings an emulated one of each other, and the pages that are for it. */
export function TryModels({ devices }: { devices: readonly Device[] }) {
  const catalog = useCatalog();
  const ports = usePorts();
  const queries = useQueryClient();
  const selection = useSelection();
  const action = useAction();
  const there = new Set<string>(devices.map((device) => device.model));
  const emulated = new Set(ports.data?.filter((port) => port.kind === "emulator").map((port) => port.model));
  const others = catalog.data?.filter((model) => emulated.has(model.name) && !there.has(model.name)) ?? [];
  if (others.length === 0 && !action.failure) return null;
  const add = async (model: Model) => {
    const body = { name: model, model, link: { kind: "emulator" } } as Schemas["DeviceCreate"];
    const device = unwrap(await api.POST("/api/v1/devices", { body }));
    await queries.invalidateQueries({ queryKey: ["devices"] });
    selection.select(device.id, 0);
  };
  return (
    <Group gap={6}>
      <Text size="sm" c="dimmed">
        Try also:
      </Text>
      {others.map((model) => (
        <Button
          key={model.name}
          size="compact-sm"
          variant="default"
          leftSection={<IconPlus size={14} aria-hidden />}
          disabled={action.busy}
          aria-label={`Add an emulated ${model.title}`}
          onClick={() => void action.run(`Adding an emulated ${model.title}`, () => add(model.name as Model))}
        >
          {model.title}
        </Button>
      ))}
      {action.failure && (
        <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
      )}
    </Group>
  );
}
