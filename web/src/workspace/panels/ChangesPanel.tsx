import { Card } from "../../lib/Card";
import { ChangesPanel as Changes } from "../../lib/rows/ChangesPanel";
import { useChipRows } from "../../lib/rows/useChipRows";
import type { DeviceProps } from "../panel";

const NO_GROUPS: readonly string[] = [];

/** Edits that wait to be written into the device. */
export function ChangesPanel({ device, axis }: DeviceProps) {
  const chip = useChipRows(device, axis?.index ?? 0, NO_GROUPS);
  return (
    <Card title="Changes" note={device.name} className="text-13">
      <Changes
        what={{ one: "register", many: "registers" }}
        staged={chip.staged}
        rows={chip.rows}
        readings={chip.live.byKey}
        axisNames={device.axes.map(({ name }) => name)}
        error={chip.apply.error}
        busy={chip.apply.isPending}
        canApply={chip.live.connected}
        onApply={() => chip.apply.mutate(undefined)}
        onDiscard={chip.discard}
      />
    </Card>
  );
}
