import { fixed } from "../../../lib/format";
import type { ChipRamp } from "../../../lib/ramp/chip";
import type { Difference } from "../../../lib/ramp/differences";
import { type Design, PARAMETERS } from "./design";
import { type Raw, REGISTERS, typedOf } from "./registers";

const POSITIONING = 0;
const MODES = ["positioning", "velocity forward", "velocity back", "hold"];

/** The chip stands in velocity mode, as after a stop: whatever is written to VMAX sets it going. */
export function waits(chip: ChipRamp | null): boolean {
  const mode = chip?.get("RAMPMODE");
  return (mode === 1 || mode === 2) && chip?.get("VACTUAL") === 0;
}

/** What a chip with ramps of eight points has besides: at 0 its ramp is the one that is drawn. */
export const FURTHER = ["V2", "TVMAX"] as const;

/**
 * The design beside the chip, in the order in which it is written: what shapes the ramp, then what may set it going. A
 * motor that stands in velocity mode is told to hold its place first; while it turns the mode is left to the commands
 * that move it.
 */
export function compared(raws: Raw, chip: ChipRamp | null): Difference[] {
  const row = (register: string, to: number): Difference => ({
    label: register,
    register,
    field: null,
    from: chip?.get(register) ?? null,
    to,
  });
  const place = waits(chip) ? [row("XTARGET", chip?.get("XACTUAL") ?? 0), row("RAMPMODE", POSITIONING)] : [];
  const shape = PARAMETERS.filter((parameter) => parameter !== "vmax");
  return [
    ...FURTHER.filter((register) => chip?.has(register)).map((register) => row(register, 0)),
    ...shape.map((parameter) => row(REGISTERS[parameter].name, raws[parameter])),
    ...place,
    row(REGISTERS.vmax.name, raws.vmax),
  ];
}

export function shownValue(row: Pick<Difference, "label">, value: number): string {
  return row.label === "RAMPMODE" ? (MODES[value] ?? fixed(value)) : fixed(value);
}

/** The design that the chip holds; null where something of it is not known, or it was never set. */
export function designOf(chip: ChipRamp, clockHz: number): Design | null {
  const design = {} as Design;
  for (const parameter of PARAMETERS) {
    const raw = chip.get(REGISTERS[parameter].name);
    if (raw === undefined) return null;
    design[parameter] = typedOf(parameter, raw, clockHz);
  }
  return design.vmax > 0 && design.amax > 0 ? design : null;
}

/** What a write would set going. */
export function cautionsOn(chip: ChipRamp | null, changed: readonly Difference[]): string[] {
  if (chip === null) return [];
  const get = (name: string) => chip.get(name) ?? 0;
  const writes = (label: string) => changed.some((row) => row.label === label);
  const positioning = get("RAMPMODE") === POSITIONING;
  const away = get("XTARGET") - get("XACTUAL");
  const moves = get("VACTUAL") !== 0;
  return [
    positioning && away !== 0 && !moves && writes("VMAX")
      ? `The target is ${fixed(away)} µsteps away: the motor starts as soon as VMAX is written.`
      : null,
    waits(chip) && writes("VMAX")
      ? "The chip stands in velocity mode: it is told to hold its place before VMAX is written, which would turn it."
      : null,
    !positioning && moves && writes("VMAX")
      ? "The chip is in velocity mode: the motor takes on VMAX as soon as it is written. A move puts it in positioning mode."
      : null,
    moves && positioning && changed.some((row) => row.label !== "VMAX")
      ? "The motor moves: other ramp values than VMAX may take it beyond its target for a while."
      : null,
  ].filter((note) => note !== null);
}
