import { useMemo, useState } from "react";
import { useCatalogModel } from "../../../api/queries";
import { type FieldRow, type RegisterRow, unpackField } from "../../../lib/rows/bits";
import type { ChipRows, Spot } from "../../../lib/rows/useChipRows";

/** What the sections need of a chip: the one that is connected, or one on paper. */
export type Registers = Pick<ChipRows, "spot" | "held" | "planned" | "isStaged" | "origin" | "put">;

/** What a chip on paper begins with, where its reset value says nothing: two thirds of the current, and half to hold. */
const BEGINS: Readonly<Record<string, number>> = {
  "IHOLD_IRUN.IRUN": 20,
  "IHOLD_IRUN.IHOLD": 10,
  "IHOLD_IRUN.IHOLDDELAY": 7,
  TPOWERDOWN: 10,
};

/** Registers of a model without a chip: values are kept by the page alone, and nothing waits. */
export function usePaperChip(model: string | undefined, axis: number): Registers {
  const catalog = useCatalogModel(model);
  const [values, setValues] = useState<Readonly<Record<string, number>>>(BEGINS);
  const rows = catalog.data?.rows;
  return useMemo(() => {
    const find = (register: string): RegisterRow | undefined =>
      rows?.find((row) => row.name === register && (row.axis === axis || row.axis === null));
    const spot = (register: string, field?: string): Spot | null => {
      const row = find(register);
      if (row === undefined) return null;
      if (field === undefined) return { row, field: null };
      const part: FieldRow | undefined = row.fields.find((candidate) => candidate.name === field);
      return part ? { row, field: part } : null;
    };
    const planned = (register: string, field?: string): number | null => {
      const at = spot(register, field);
      if (at === null) return null;
      const own = values[nameOf(register, field)];
      if (own !== undefined) return own;
      const reset = at.row.reset ?? 0;
      return at.field ? unpackField(reset, at.field) : reset;
    };
    return {
      spot,
      planned,
      held: planned,
      isStaged: () => false,
      origin: () => "unknown" as const,
      put: (register, field, value) => setValues((now) => ({ ...now, [nameOf(register, field)]: value })),
    };
  }, [rows, axis, values]);
}

function nameOf(register: string, field: string | undefined): string {
  return field === undefined ? register : `${register}.${field}`;
}

/** Which of the threshold registers a model has: times between steps, or velocities. */
export const THRESHOLDS = {
  tstep: { stealth: "TPWMTHRS", cool: "TCOOLTHRS", high: "THIGH" },
  velocity: { stealth: null, cool: "VCOOLTHRS", high: "VHIGH" },
} as const;

export function thresholdKind(chip: Registers): "tstep" | "velocity" {
  return chip.spot("VHIGH") === null ? "tstep" : "velocity";
}
