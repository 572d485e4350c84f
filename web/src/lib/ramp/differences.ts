import type { Schemas } from "../../api/client";

export type BatchItem = Schemas["RegisterBatchItem"];

/** One line of the difference between chip and design. */
export interface Difference {
  /** register or field, as it is shown */
  label: string;
  register: string;
  /** null where the whole register is one value */
  field: string | null;
  /** null while the chip's is unknown */
  from: number | null;
  to: number;
}

export function changedOf<D extends Difference>(differences: readonly D[] | null): D[] {
  return differences?.filter((row) => row.from !== row.to) ?? [];
}

/** The writes for what differs, in its order; fields of one register go together, and what does not differ stays. */
export function writesFor(differences: readonly Difference[], axis: number): BatchItem[] {
  const writes: BatchItem[] = [];
  for (const { register, field, from, to } of differences) {
    if (from === to) continue;
    const last = writes.find((write) => write.name === register);
    if (field === null) writes.push({ name: register, axis, value: to });
    else if (last) last.fields = { ...last.fields, [field]: to };
    else writes.push({ name: register, axis, fields: { [field]: to } });
  }
  return writes;
}
