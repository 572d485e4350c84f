import { useContext } from "react";
import { useSelection } from "../../live/selection";
import { EmulatorPanel as Emulator } from "../../pages/bench/EmulatorPanel";
import { WorkspaceContext } from "../context";
import { closed } from "../edits";
import type { DeviceProps } from "../panel";

export function EmulatorPanel({ id, device, axis }: DeviceProps) {
  const { document, put } = useContext(WorkspaceContext);
  const { select } = useSelection();
  return (
    <Emulator
      device={device}
      axis={axis?.index ?? 0}
      onAxis={(next) => select(device.id, next)}
      onClose={() => put(closed(document, id), "The emulator's panel is closed")}
    />
  );
}
