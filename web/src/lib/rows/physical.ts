import type { Schemas } from "../../api/client";
import type { Device } from "../../api/queries";
import { compact, duration, frequency, withUnit } from "../format";
import { type AxisScale, factorOf, fromSteps, scaleOf, symbolOf } from "../units";
import { type FieldRow, type RegisterRow, unpackField } from "./bits";
import type { Scale } from "./input";

type Reading = Schemas["RegisterReading"];
type Motion = "position" | "velocity" | "acceleration";

/** The axis' scale with the dividers as the chip just showed them; where it did not, as the server last knew them. */
export function liveScale(
  device: Pick<Device, "axes" | "clock_hz">,
  axis: number,
  readings: readonly Reading[] | undefined,
): AxisScale {
  const known = scaleOf(device.axes[axis], device.clock_hz);
  const packed = readings?.find((reading) => reading.axis === axis && /^pulse_div_/i.test(reading.name));
  const fields = Object.fromEntries(
    Object.entries(packed?.fields ?? {}).map(([name, value]) => [name.toLowerCase(), value]),
  );
  return {
    ...known,
    pulseDiv: fields.pulse_div ?? known.pulseDiv,
    rampDiv: fields.ramp_div ?? known.rampDiv,
    microstepsPerFullStep: fields.usrs === undefined ? known.microstepsPerFullStep : 2 ** fields.usrs,
  };
}

/** What a number measures, by the formula that the catalog gives as its unit. */
export function motionOf(unit: string): Motion | null {
  if (unit.startsWith("fCLK^2/")) return "acceleration";
  if (unit.startsWith("fCLK/(65536") || unit in PPS) return "velocity";
  return unit === "microsteps" ? "position" : null;
}

/** Units that hang on nothing but the chip's clock: how many steps a second 1 in the register is. */
const PPS: Readonly<Record<string, (clockHz: number) => number>> = {
  pps: () => 1,
  "1/256 pps": () => 1 / 256,
  "fCLK/2^24 pps": (clockHz) => clockHz / 2 ** 24,
};
const PPS2: Readonly<Record<string, (clockHz: number) => number>> = {
  "fCLK^2/2^41 pps^2": (clockHz) => clockHz ** 2 / 2 ** 41,
};

/** Units that would not fit beside a number. */
const BRIEF: Readonly<Record<string, string>> = {
  "1/4 pps^2": "¼ pps²",
  "pps^2": "pps²",
  "pps^3": "pps³",
  revolutions: "rev",
  "counts/rev": "c/rev",
  "15.16 bits": "15.16",
  "1/256, plus 1/256": "",
  "microsteps/2^31": "µst/2³¹",
  "1/1024 electrical turn": "turn/1024",
  "fCLK/2^24 pps": "chip",
  "2^18 tCLK": "2¹⁸ tCLK",
  "1/65536 or 1/10000 microsteps": "",
  // scales with an offset: the help has them
  "1/32, plus 1/32": "",
  "1, plus 1": "",
  "1, minus 3": "",
  "32, plus 32": "",
  "32": "× 32",
};

/** A short unit for beside the number; the catalog's formula is in the help. */
export function chipUnit(unit: string): string {
  const motion = motionOf(unit);
  if (motion === "position") return symbolOf("microsteps");
  const brief = BRIEF[unit];
  if (brief !== undefined) return brief;
  if (unit in PPS) return unit;
  if (motion !== null) return symbolOf("chip");
  if (unit === "sequencer steps") return "steps";
  return unit.startsWith("fCLK/32") ? "" : unit; // an exponent has none; `derived` tells what it comes to
}

const SHOWN: Record<Motion, readonly string[]> = {
  position: ["rev", "deg", "mm"],
  velocity: ["pps", "rpm", "mm_per_s"],
  acceleration: ["pps2", "rpm_per_s", "mm_per_s2"],
};

/** Physical units of a register's number, most telling first; none where the axis cannot say. */
export function scalesOf(unit: string, scale: AxisScale | null): Scale[] {
  if (scale === null) return [];
  const clocks = clocksIn(unit);
  if (clocks !== null)
    return clocks < 512
      ? [{ unit: "µs", perChip: (clocks * 1e6) / scale.clockHz }]
      : [{ unit: "ms", perChip: (clocks * 1e3) / scale.clockHz }];
  const motion = motionOf(unit);
  if (motion === null) return [];
  const chip = (PPS[unit] ?? PPS2[unit])?.(scale.clockHz) ?? factorOf("chip", scale, motion);
  if (chip === null) return [];
  return SHOWN[motion].flatMap((name) => {
    const steps = factorOf(name, scale, motion);
    return steps === null ? [] : [{ unit: symbolOf(name), perChip: chip / steps }];
  });
}

/** Those of a field: one whose values have names is no proportion, nor is what counts from one. */
export function fieldScales(field: Pick<FieldRow, "name" | "unit" | "values">, scale: AxisScale | null): Scale[] {
  return Object.keys(field.values).length > 0 || countsFromOne(field) ? [] : scalesOf(field.unit, scale);
}

/** A TMC4210's step pulse: 16 * (1 + STPDIV) clocks. */
function countsFromOne({ name }: { name: string }): boolean {
  return name.startsWith("STPDIV");
}

/** How many clocks 1 is: of "tCLK" 1, of "2^18 tCLK" 262 144; null where the unit is no time. */
function clocksIn(unit: string): number | null {
  const [, count] = /^(?:(\d+|2\^\d+) )?tCLK$/.exec(unit) ?? [];
  if (count === undefined) return unit === "tCLK" ? 1 : null;
  return numberIn(count);
}

/** "54" and "2^18" as numbers. */
function numberIn(text: string): number {
  const power = /^2\^(\d+)$/.exec(text);
  return power ? 2 ** Number(power[1]) : Number(text);
}

/** What a number comes to where no proportion tells: dividers as frequencies, clocks as times. */
export function derived(
  bits: Pick<FieldRow | RegisterRow, "name" | "unit"> & { values?: Readonly<Record<string, string>> },
  value: number,
  clockHz: number,
): string {
  if (bits.unit === "fCLK/32/2^n") return frequency(clockHz / 32 / 2 ** value);
  if (bits.name === "clk2_div") return frequency(clockHz / (2 * (value + 1)));
  const clocks = clocksIn(bits.unit);
  if (clocks === null) return "";
  // some count in steps of their own, which are their values' names
  const named = bits.values?.[String(value)];
  const count = named === undefined ? value : numberIn(named);
  return Number.isFinite(count) ? duration((clocks * (countsFromOne(bits) ? count + 1 : count)) / clockHz) : "";
}

const STEP_TIMES = ["TSTEP", "TPWMTHRS", "TCOOLTHRS", "THIGH"];
/** What a TMC5xxx counts the time between steps in: microsteps of this many a full step, whatever the axis has. */
const STEP_TIME_MICROSTEPS = 256;

/** The velocity that a time between two steps stands for, in the axis's microsteps; nothing for any other register. */
export function speedsOf(row: Pick<RegisterRow, "name" | "unit" | "width">, value: number, scale: AxisScale): string[] {
  if (!STEP_TIMES.includes(row.name) || row.unit !== "tCLK" || value === 0) return [];
  if (row.name === "TSTEP" && value >= 2 ** row.width - 1) return ["at rest"];
  const own = scale.microstepsPerFullStep ?? STEP_TIME_MICROSTEPS;
  const pps = (scale.clockHz / value) * (own / STEP_TIME_MICROSTEPS);
  return ["pps", "rpm"].map((unit) => withUnit(fromSteps(pps, unit, scale, "velocity"), symbolOf(unit), 3));
}

/** p of a pmul/pdiv pair, or nothing for any other register. */
export function pairText(row: RegisterRow, raw: number): string {
  if (!/^pmul_pdiv$/i.test(row.name)) return "";
  const part = (name: string) => row.fields.find((field) => field.name.toLowerCase() === name);
  const [pmul, pdiv] = [part("pmul"), part("pdiv")];
  if (!pmul || !pdiv) return "";
  // TMC428 counts pmul without its fixed leading one (7 bits), TMC4210 with it (8 bits).
  const mantissa = unpackField(raw, pmul) + (pmul.width === 7 ? 128 : 0);
  return `p ${compact(mantissa / 2 ** (3 + unpackField(raw, pdiv)))}`;
}

/** A chip value in its physical units: `1907 pps · 8.94 rpm · 0.298 mm/s`. */
export function physicalText(value: number, scales: readonly Scale[]): string {
  return scales.map((scale) => withUnit(value * scale.perChip, scale.unit)).join(" · ");
}
