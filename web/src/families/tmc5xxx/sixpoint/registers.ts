import { rounded } from "../../../lib/format";
import { type Design, PARAMETERS, type Parameter } from "./design";

/**
 * The registers of a SixPoint ramp: names, greatest values and what 1 in them stands for. All hang on fCLK: velocities
 * count fCLK/2^24 pps, accelerations fCLK²/2^41 pps², the wait 512 clocks (data sheet of the TMC5160, "Ramp generator
 * registers", and those of the others likewise).
 */
export const REGISTERS: Record<Parameter, { name: string; most: number }> = {
  vstart: { name: "VSTART", most: 2 ** 18 - 1 },
  a1: { name: "A1", most: 2 ** 16 - 1 },
  v1: { name: "V1", most: 2 ** 20 - 1 },
  amax: { name: "AMAX", most: 2 ** 16 - 1 },
  vmax: { name: "VMAX", most: 2 ** 23 - 512 },
  dmax: { name: "DMAX", most: 2 ** 16 - 1 },
  d1: { name: "D1", most: 2 ** 16 - 1 },
  vstop: { name: "VSTOP", most: 2 ** 18 - 1 },
  tzerowait: { name: "TZEROWAIT", most: 2 ** 16 - 1 },
};

/** What 1 in the register of `parameter` stands for [pps, pps², s]. */
export function unitOf(parameter: Parameter, clockHz: number): number {
  if (parameter === "tzerowait") return 512 / clockHz;
  return parameter.startsWith("v") ? clockHz / 2 ** 24 : clockHz ** 2 / 2 ** 41;
}

/**
 * The nearest number that the register can hold; an acceleration or VMAX that is wished for stays above 0, as the
 * calculator has it.
 */
export function rawOf(parameter: Parameter, value: number, clockHz: number): number {
  const least = value > 0 && (parameter === "vmax" || /^[ad]/.test(parameter)) ? 1 : 0;
  return Math.min(REGISTERS[parameter].most, Math.max(least, Math.round(value / unitOf(parameter, clockHz))));
}

export type Raw = Record<Parameter, number>;

export function rawsOf(design: Design, clockHz: number): Raw {
  return Object.fromEntries(
    PARAMETERS.map((parameter) => [parameter, rawOf(parameter, design[parameter], clockHz)]),
  ) as Raw;
}

/** What registers stand for: a design without what rounding takes away. */
export function designOfRaws(raws: Raw, clockHz: number): Design {
  return Object.fromEntries(
    PARAMETERS.map((parameter) => [parameter, raws[parameter] * unitOf(parameter, clockHz)]),
  ) as unknown as Design;
}

/** The register's number as a value that a person would type: as short as still gives the same number. */
export function typedOf(parameter: Parameter, raw: number, clockHz: number): number {
  const unit = unitOf(parameter, clockHz);
  const most = REGISTERS[parameter].most * unit;
  for (let digits = 3; digits < 15; digits++) {
    const short = rounded(raw * unit, digits);
    if (short <= most && rawOf(parameter, short, clockHz) === raw) return short;
  }
  return raw * unit;
}
