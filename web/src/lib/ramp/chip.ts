import type { Schemas } from "../../api/client";
import type { RegisterRow } from "../rows/bits";
import { type Counting, parameterFor, parameterOf, rawOf } from "../rows/driver";
import type { BatchItem } from "./differences";

/** What is known of an axis' registers, by their names: read, or as last written where they cannot be read. */
export type ChipRamp = ReadonlyMap<string, number>;

/** Packed registers answer by their fields as well. */
export function chipRamp(readings: readonly Schemas["RegisterReading"][]): ChipRamp {
  return new Map(readings.flatMap(({ name, value, fields }) => [[name, value], ...Object.entries(fields)]));
}

/** How a module's parameters are registers of the driver chip in it. */
export interface Dialect {
  chip: ChipRamp;
  /** the write of a register as one of a parameter */
  write: (item: BatchItem) => BatchItem;
  /** what a parameter holds after a write, as the register */
  raw: (register: string, value: number) => number;
}

export function dialectOf(
  rows: readonly RegisterRow[],
  readings: readonly Schemas["RegisterReading"][],
  counts: Omit<Counting, "inPps">,
): Dialect {
  const held = new Map(readings.map(({ name, value }) => [name, value]));
  const counting = { ...counts, inPps: held.get("unit_mode") !== 0 };
  const chip = new Map<string, number>();
  for (const row of rows) {
    const value = held.get(row.name);
    if (row.driver?.field === "" && value !== undefined) chip.set(row.driver.name, rawOf(row, value, counting));
  }
  return {
    chip,
    write: (item) => {
      const row = parameterFor(rows, item.name);
      return row && item.value != null
        ? { ...item, name: row.name, value: parameterOf(row, item.value, counting) }
        : item;
    },
    raw: (register, value) => {
      const row = parameterFor(rows, register);
      return row ? rawOf(row, value, counting) : value;
    },
  };
}
