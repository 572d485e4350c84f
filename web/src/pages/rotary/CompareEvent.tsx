import { Checkbox } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { api } from "../../api/client";
import type { Device } from "../../api/queries";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useChipRows } from "../../lib/rows/useChipRows";

const GROUPS = ["position compare"] as const;
/** Of the register of the compare interrupt. */
const MASK = "M";

/** Whether the compare is an interrupt too, and so an event below the scope; nothing for chips that ask nobody. */
export function CompareEvent({ device, axis, disabled }: { device: Device; axis: number; disabled: boolean }) {
  const chip = useChipRows(device, axis, GROUPS);
  const row = [...chip.rows.values()].find(
    ({ group, fields }) => group === GROUPS[0] && fields.some(({ name }) => name === MASK),
  );
  const write = useMutation({
    mutationFn: (on: boolean) =>
      api.PUT("/api/v1/devices/{device}/registers/{name}", {
        path: { device: device.id, name: row?.name ?? "" },
        body: { fields: { [MASK]: on ? 1 : 0 } },
      }),
    onSettled: () => chip.live.readings.refetch(),
  });
  if (row === undefined) return null;
  const held = chip.held(row.name, MASK);
  return (
    <>
      <Checkbox
        mt={6}
        label="and as an interrupt, an event below the scope"
        title={`${row.name}.${MASK}`}
        checked={write.isPending ? write.variables : held === 1}
        indeterminate={held === null}
        disabled={disabled || write.isPending}
        onChange={(event) => write.mutate(event.currentTarget.checked)}
        data-testid="compare-event"
      />
      {write.isError && <ProblemAlert error={write.error} doing="Setting the mask" onClose={write.reset} />}
    </>
  );
}
