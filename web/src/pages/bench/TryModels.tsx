import { Button, Group, Popover, Stack, Text } from "@mantine/core";
import { useMediaQuery } from "@mantine/hooks";
import { IconChevronDown, IconPlus } from "@tabler/icons-react";
import { useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";
import { type Device, useCatalog } from "../../api/queries";
import { byFamily, commonTitle } from "../../lib/models";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useSelection } from "../../live/selection";
import { usePorts } from "../connections/queries";
import { useAction } from "./motion/useAction";

type Model = Schemas["DeviceCreate"]["model"];
type Entry = Schemas["CatalogEntry"];

/** Narrower than this, a button for each family does not fit beside what else the bar holds. */
const ROOM_FOR_ALL = "(min-width: 84em)";

const LOOK = { size: "compact-sm", variant: "default", leftSection: <IconPlus size={14} aria-hidden /> } as const;

/** The demo has two of the families: one click brings an emulated one of each other, and the pages that are for it. */
export function TryModels({ devices }: { devices: readonly Device[] }) {
  const catalog = useCatalog();
  const ports = usePorts();
  const queries = useQueryClient();
  const selection = useSelection();
  const action = useAction();
  const roomy = useMediaQuery(ROOM_FOR_ALL, true, { getInitialValueInEffect: false });
  const there = new Set<string>(devices.map((device) => device.model));
  const emulated = new Set(ports.data?.filter((port) => port.kind === "emulator").map((port) => port.model));
  const others = catalog.data?.filter((model) => emulated.has(model.name) && !there.has(model.name)) ?? [];
  if (others.length === 0 && !action.failure) return null;
  const add = async (model: Model) => {
    const body = { name: model, model, link: { kind: "emulator" }, start_up: true } as Schemas["DeviceCreate"];
    const device = await api.POST("/api/v1/devices", { body });
    await queries.invalidateQueries({ queryKey: ["devices"] });
    selection.select(device.id, 0);
  };
  const put = (model: Entry) => void action.run(`Adding an emulated ${model.title}`, () => add(model.name as Model));
  const families = [...byFamily(others)];
  const list = (models: readonly Entry[], label: string, name: string) => (
    <Popover key={label} position="bottom-start" trapFocus>
      <Popover.Target>
        <Button
          {...LOOK}
          disabled={action.busy}
          rightSection={<IconChevronDown size={14} aria-hidden />}
          aria-label={name}
        >
          {label}
        </Button>
      </Popover.Target>
      <Popover.Dropdown p={4} mah="60vh" className="scroll" aria-label={label}>
        <Stack gap={0}>
          {models.map((model) => (
            <Button
              key={model.name}
              variant="subtle"
              color="gray"
              justify="space-between"
              flex="none"
              disabled={action.busy}
              aria-label={`Add an emulated ${model.title}`}
              rightSection={
                <Text span size="xs" c="dimmed">
                  {model.axes === 1 ? "1 axis" : `${model.axes} axes`}
                </Text>
              }
              onClick={() => put(model)}
            >
              {model.title}
            </Button>
          ))}
        </Stack>
      </Popover.Dropdown>
    </Popover>
  );
  return (
    <Group gap={6} wrap="nowrap" flex="none" data-roomy={roomy && families.length > 2}>
      {roomy ? (
        <>
          <Text size="sm" c="dimmed">
            Try also:
          </Text>
          {families.map(([family, models]) => {
            const [first] = models;
            return models.length === 1 && first ? (
              <Button
                key={family}
                {...LOOK}
                disabled={action.busy}
                aria-label={`Add an emulated ${first.title}`}
                onClick={() => put(first)}
              >
                {first.title}
              </Button>
            ) : (
              list(models, commonTitle(models), `Add one of the emulated ${commonTitle(models)}`)
            );
          })}
        </>
      ) : (
        list(
          families.flatMap(([, models]) => models),
          "Try also",
          "Add another emulated device",
        )
      )}
      {action.failure && (
        <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
      )}
    </Group>
  );
}
