import type { Schemas } from "../../../api/client";
import { can, type Device } from "../../../api/queries";
import type { Difference } from "../../../lib/ramp/differences";

export type Model = NonNullable<Schemas["PmulPdiv"]["chip"]>;

/** The model of a chip whose ramps hang on pmul and pdiv; of any other device, and without one, null. */
export function modelOf(device: Device | undefined): Model | null {
  return can(device, "ramp.pmul") ? (device?.model as Model) : null;
}

export type Reading = Schemas["RegisterReading"];

/** The motion registers of an axis that a ramp is designed from, in chip units. */
export interface RampDesign {
  v_min: number;
  v_max: number;
  a_max: number;
  pulse_div: number;
  ramp_div: number;
  /** null where the chip has none: the TMC4210's driver makes the microsteps */
  usrs: number | null;
}

/** pmul is counted 0..127 here, whatever the chip's data sheet does. */
export interface Pair {
  pmul: number;
  pdiv: number;
}

export type PositionMode = "ramp" | "soft";
export type RampMode = PositionMode | "velocity";

/** What the chip holds of a design. */
export interface ChipRamp {
  design: RampDesign;
  pair: Pair;
  /** as the register says: 0 ramp, 1 soft, 2 velocity, 3 hold */
  mode: number;
  position: number | null;
  target: number | null;
}

export type RampKey = keyof RampDesign | keyof Pair | "mode";

const PACKED: Record<Model, { pair: string; dividers: string; mode: [register: string, field: string] }> = {
  tmc428: { pair: "pmul_pdiv", dividers: "pulse_div_ramp_div_usrs", mode: ["lp_ref_conf_rm", "rm"] },
  tmc429: { pair: "pmul_pdiv", dividers: "pulse_div_ramp_div_usrs", mode: ["lp_ref_conf_rm", "rm"] },
  tmc4210: { pair: "PMUL_PDIV", dividers: "PULSE_DIV_RAMP_DIV", mode: ["lp_REF_CONF_RAMP_MODE", "RAMP_MODE"] },
};

/** The data sheet of the TMC4210 writes register names in capitals and counts PMUL with its fixed top bit. */
const spelled = (model: Model, name: string) => (model === "tmc4210" ? name.toUpperCase() : name);
const PMUL_BASE: Record<Model, number> = { tmc428: 0, tmc429: 0, tmc4210: 128 };

export function labelOf(model: Model, key: string): string {
  return spelled(model, key);
}

/** The design that an axis' readings hold; null where a register is missing. */
export function fromReadings(model: Model, readings: readonly Reading[]): ChipRamp | null {
  const values = new Map<string, number>();
  for (const reading of readings) {
    values.set(reading.name.toLowerCase(), reading.value);
    for (const [field, value] of Object.entries(reading.fields)) values.set(field.toLowerCase(), value);
  }
  const get = (name: string) => values.get(name) ?? Number.NaN;
  const chip: ChipRamp = {
    design: {
      v_min: get("v_min"),
      v_max: get("v_max"),
      a_max: get("a_max"),
      pulse_div: get("pulse_div"),
      ramp_div: get("ramp_div"),
      usrs: model === "tmc4210" ? null : get("usrs"),
    },
    pair: { pmul: get("pmul") - PMUL_BASE[model], pdiv: get("pdiv") },
    mode: get(PACKED[model].mode[1].toLowerCase()),
    position: values.get("x_actual") ?? null,
    target: values.get("x_target") ?? null,
  };
  const numbers = [...Object.values(chip.design), chip.pair.pmul, chip.pair.pdiv, chip.mode];
  return numbers.some((value) => Number.isNaN(value)) ? null : chip;
}

export interface RampDifference extends Difference {
  key: RampKey;
}

/** A ramp mode goes along only between the two that position: leaving velocity mode would start the motor. */
export function modeToWrite(chip: ChipRamp | null, mode: RampMode): 0 | 1 | null {
  if (mode === "velocity" || chip === null || chip.mode > 1) return null;
  return mode === "ramp" ? 0 : 1;
}

/**
 * Every value of the design beside the chip's own, in the order in which they are written: dividers first (they scale
 * everything else), then the pair, then the limits.
 */
export function compared(
  model: Model,
  design: RampDesign,
  pair: Pair,
  mode: RampMode,
  chip: ChipRamp | null,
): RampDifference[] {
  const packed = PACKED[model];
  const row = (key: RampKey, register: string, from: number | null | undefined, to: number): RampDifference => ({
    key,
    label: spelled(model, key),
    register,
    field: register === spelled(model, key) ? null : spelled(model, key),
    from: from ?? null,
    to,
  });
  const base = PMUL_BASE[model];
  const rows = [
    row("pulse_div", packed.dividers, chip?.design.pulse_div, design.pulse_div),
    row("ramp_div", packed.dividers, chip?.design.ramp_div, design.ramp_div),
    ...(design.usrs === null ? [] : [row("usrs", packed.dividers, chip?.design.usrs, design.usrs)]),
    row("pmul", packed.pair, chip ? chip.pair.pmul + base : null, pair.pmul + base),
    row("pdiv", packed.pair, chip?.pair.pdiv, pair.pdiv),
    ...(["a_max", "v_min", "v_max"] as const).map((key) =>
      row(key, spelled(model, key), chip?.design[key], design[key]),
    ),
  ];
  const wanted = modeToWrite(chip, mode);
  return wanted === null
    ? rows
    : [...rows, { ...row("mode", packed.mode[0], chip?.mode, wanted), label: packed.mode[1], field: packed.mode[1] }];
}

export function pOf(pair: Pair): number {
  return (128 + pair.pmul) / 2 ** (3 + pair.pdiv);
}

/** The p that a ramp needs (TMC428 data sheet, 8.11). */
export function idealP(design: Pick<RampDesign, "a_max" | "ramp_div" | "pulse_div">): number {
  return design.a_max / (128 * 2 ** (design.ramp_div - design.pulse_div));
}

/** The pair nearest to `p`; null where none is near (p below 1/512, or 32 and more). */
export function pairNear(p: number): Pair | null {
  if (!(p > 0)) return null;
  let pdiv = Math.floor(Math.log2(256 / p)) - 3;
  let pMul = Math.round(p * 2 ** (3 + pdiv));
  if (pMul > 255) {
    pdiv -= 1;
    pMul = Math.round(p * 2 ** (3 + pdiv));
  }
  if (pdiv < 0 || pdiv > 13 || pMul < 128) return null;
  return { pmul: pMul - 128, pdiv };
}

/** Steps from rest to v_max at a_max (TMC428 data sheet, 8.14). */
export function accelerationSteps(design: RampDesign): number {
  return (design.v_max ** 2 / design.a_max) * 2 ** (design.ramp_div - design.pulse_div - 4);
}

/** Two leading digits: 12 345 becomes 12 000. */
export function rounded(value: number): number {
  if (!(value > 0) || !Number.isFinite(value)) return 0;
  const unit = 10 ** Math.max(0, Math.floor(Math.log10(value)) - 1);
  return Math.round(value / unit) * unit;
}

/** A distance on which accelerating, cruising and braking can all be seen. */
export function showingDistance(design: RampDesign): number {
  const steps = rounded(3 * accelerationSteps(design));
  return Math.min(4_000_000, Math.max(100, steps));
}

export const START: RampDesign = { v_min: 4, v_max: 1000, a_max: 400, pulse_div: 4, ramp_div: 7, usrs: 6 };

/** The parameters of POST /calc/ramp. */
export function rampParameters(
  design: RampDesign,
  pair: Pair,
  mode: RampMode,
  clockHz: number,
): Record<string, number | string> {
  const { usrs: _usrs, ...registers } = design;
  return {
    ...registers,
    ...pair,
    ramp_mode: mode,
    clock_hz: clockHz,
    ...(mode === "velocity" ? { v_target: design.v_max } : {}),
  };
}
