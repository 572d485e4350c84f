import { ActionIcon, Menu } from "@mantine/core";
import { IconDots } from "@tabler/icons-react";
import { useContext } from "react";
import { useDevices } from "../api/queries";
import { putIntoAddress } from "../lib/address";
import { WorkspaceContext } from "./context";
import { idsIn, MOTION, SELECTED, set } from "./document";
import { closed, mayClose } from "./edits";
import { titleOf, typeOf } from "./panels";

export type Side = "left" | "right" | "above" | "below" | "into";

const SIDES: readonly (readonly [side: Side, words: string])[] = [
  ["left", "Move left of"],
  ["right", "Move right of"],
  ["above", "Move above"],
  ["below", "Move below"],
  ["into", "Move into the tabs of"],
];

interface Props {
  id: string;
  move: (side: Side, other: string) => void;
}

/** Everything that can be done to a panel, without dragging. */
export function PanelMenu({ id, move }: Props) {
  const { document, put } = useContext(WorkspaceContext);
  const devices = useDevices();
  const title = titleOf(document, id);
  const entry = document.panels[id];
  const moves = entry?.type === MOTION;
  const others = idsIn(document.screens.desktop).filter((other) => other !== id);
  const axes = (devices.data ?? []).flatMap((device) =>
    device.axes.map((axis) => [`${device.id}/${axis.index}`, `${device.name} · ${axis.name}`] as const),
  );
  const mayPin = typeOf(entry?.type)?.wants !== "nothing" || moves;
  return (
    <Menu position="bottom-end" withinPortal>
      <Menu.Target>
        <ActionIcon size="sm" variant="subtle" aria-label={`Menu of ${title}`} title={`Menu of ${title}`}>
          <IconDots size={16} />
        </ActionIcon>
      </Menu.Target>
      <Menu.Dropdown>
        {SIDES.map(([side, words]) => {
          const fit = others.filter((other) => side !== "into" || !(moves || document.panels[other]?.type === MOTION));
          return (
            fit.length > 0 && (
              <Menu.Sub key={side}>
                <Menu.Sub.Target>
                  <Menu.Sub.Item>{words}</Menu.Sub.Item>
                </Menu.Sub.Target>
                <Menu.Sub.Dropdown>
                  {fit.map((other) => (
                    <Menu.Item key={other} onClick={() => move(side, other)}>
                      {titleOf(document, other)}
                    </Menu.Item>
                  ))}
                </Menu.Sub.Dropdown>
              </Menu.Sub>
            )
          );
        })}
        <Menu.Divider />
        {mayPin && (
          <Menu.Sub>
            <Menu.Sub.Target>
              <Menu.Sub.Item>Show the axis</Menu.Sub.Item>
            </Menu.Sub.Target>
            <Menu.Sub.Dropdown>
              {[[SELECTED, "The selected one"] as const, ...axes].map(([at, name]) => (
                <Menu.Item
                  key={at}
                  aria-current={entry?.at === at || undefined}
                  onClick={() => put(set(document, id, { at }), `${title} shows ${name}`)}
                >
                  {name}
                </Menu.Item>
              ))}
            </Menu.Sub.Dropdown>
          </Menu.Sub>
        )}
        <Menu.Item onClick={() => putIntoAddress({ max: id }, "step")}>Maximise</Menu.Item>
        <Menu.Item
          disabled={!mayClose(document, id)}
          onClick={() => put(closed(document, id), `${title} is closed`)}
          color="red"
        >
          Close
        </Menu.Item>
      </Menu.Dropdown>
    </Menu>
  );
}
