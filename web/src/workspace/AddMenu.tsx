import { Button, Menu } from "@mantine/core";
import { IconPlus } from "@tabler/icons-react";
import { useSelection } from "../live/selection";
import { addOf } from "./adding";
import type { Layout } from "./layout";
import { misfit } from "./panel";
import { PANELS } from "./panels";

/** Panels that can be put into the layout; those that do not fit the device say why. */
export function AddMenu({ layout }: { layout: Layout }) {
  const { document, put } = layout;
  const { device, axis } = useSelection();
  const there = new Set(Object.values(document.panels).map(({ type }) => type));
  return (
    <Menu position="bottom-end" withinPortal>
      <Menu.Target>
        <Button size="compact-sm" variant="default" leftSection={<IconPlus size={14} aria-hidden />}>
          Add a panel
        </Button>
      </Menu.Target>
      <Menu.Dropdown mah="70dvh" style={{ overflowY: "auto" }}>
        {PANELS.filter(({ single, type }) => !(single && there.has(type))).map((type) => {
          const why = misfit(type, device, device?.axes[axis]);
          return (
            <Menu.Item
              key={type.type}
              disabled={why !== null}
              title={why ?? undefined}
              onClick={() => put(addOf(document, type), `${type.title} is at the right`)}
            >
              {type.title}
            </Menu.Item>
          );
        })}
      </Menu.Dropdown>
    </Menu>
  );
}
