import type { RegisterRow } from "./bits";
import type { ChipRows, Spot } from "./useChipRows";

/** What a module counts its speeds by: the clock of its driver, its microsteps, and whether they are in pps (unit mode). */
export interface Counting {
  clockHz: number;
  microsteps: number;
  inPps: boolean;
}

/** Thresholds count clocks between two 256ths of a full step. */
const CLOCKS: readonly string[] = ["TPWMTHRS", "TCOOLTHRS", "THIGH"];
const CLOCKS_MAX = 2 ** 20 - 1;

/** What 1 in a register of the ramp generator is, in the unit of the parameter. */
function grain({ unit }: RegisterRow, { clockHz, inPps }: Counting): number | null {
  if (!inPps) return unit.startsWith("pps") ? 1 : null;
  if (unit === "pps") return clockHz / 2 ** 24;
  return unit === "pps^2" ? clockHz ** 2 / 2 ** 41 : null;
}

/** A parameter's value as the register of the driver chip holds it. */
export function rawOf(row: RegisterRow, value: number, counting: Counting): number {
  const { clockHz, microsteps, inPps } = counting;
  if (CLOCKS.includes(row.driver?.name ?? "")) {
    const pps = inPps ? value : (value * clockHz) / 2 ** 24;
    return pps > 0 ? Math.min(CLOCKS_MAX, Math.round((clockHz * microsteps) / 256 / pps)) : CLOCKS_MAX;
  }
  const unit = grain(row, counting);
  const { step = 1, offset = 0 } = row.driver ?? {};
  return unit === null ? Math.max(0, Math.floor((value - offset) / step)) : Math.round(value / unit);
}

/** The parameter's value that the driver chip takes as `raw`: within what the module allows. */
export function parameterOf(row: RegisterRow, raw: number, counting: Counting): number {
  const { clockHz, microsteps, inPps } = counting;
  const unit = grain(row, counting);
  const { step = 1, offset = 0 } = row.driver ?? {};
  let value = unit === null ? raw * step + offset : Math.round(raw * unit);
  if (CLOCKS.includes(row.driver?.name ?? "")) {
    const pps = raw >= CLOCKS_MAX ? 0 : raw === 0 ? Number.POSITIVE_INFINITY : (clockHz * microsteps) / 256 / raw;
    value = Math.round(inPps ? pps : (pps * 2 ** 24) / clockHz);
  }
  const [least, most] = (inPps ? null : row.internal_range) ?? [row.minimum, row.maximum];
  return Math.min(most ?? value, Math.max(least ?? value, value));
}

/** The parameter that sets a register of the driver chip, or a field of it. */
export function parameterFor(rows: Iterable<RegisterRow>, register: string, field = ""): RegisterRow | undefined {
  for (const row of rows) if (row.driver?.name === register && row.driver.field === field) return row;
  return undefined;
}

type Registers = Pick<ChipRows, "spot" | "held" | "planned" | "isStaged" | "origin" | "put">;

/** A module's parameters as the registers of its driver chip: a page of those need not know which of both it shows. */
export function asDriver(chip: ChipRows, counting: Counting): Registers {
  const of = (register: string, field?: string) => parameterFor(chip.rows.values(), register, field);
  const value = (register: string, field: string | undefined, read: (name: string) => number | null) => {
    const row = of(register, field);
    const found = row ? read(row.name) : null;
    return row === undefined || found === null ? null : rawOf(row, found, counting);
  };
  return {
    spot: (register, field): Spot | null => {
      const row = of(register, field);
      if (row === undefined) return null;
      const ends = [row.minimum, row.maximum].map((end) => rawOf(row, end, { ...counting, inPps: true }));
      const help = `${row.help} (${row.alias})`;
      const maximum = Math.max(...ends);
      const clocks = CLOCKS.includes(register);
      const width = maximum === 1 ? 1 : row.width;
      const minimum = clocks ? 0 : Math.min(...ends);
      return { row: { ...row, help, width, minimum, maximum, unit: clocks ? "tCLK" : "" }, field: null };
    },
    held: (register, field) => value(register, field, chip.held),
    planned: (register, field) => value(register, field, chip.planned),
    isStaged: (register, field) => chip.isStaged(of(register, field)?.name ?? ""),
    origin: (register) =>
      chip.origin([...chip.rows.values()].find(({ driver }) => driver?.name === register)?.name ?? ""),
    put: (register, field, raw) => {
      const row = of(register, field);
      if (row) chip.put(row.name, undefined, parameterOf(row, raw, counting));
    },
  };
}
