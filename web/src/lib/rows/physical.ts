import type { Schemas } from "../../api/client";
import { compact, duration, frequency, withUnit } from "../format";
import { type AxisScale, factorOf, scaleOf, symbolOf } from "../units";
import { type FieldRow, type RegisterRow, unpackField } from "./bits";
import type { Scale } from "./input";

type Reading = Schemas["RegisterReading"];
type Motion = "position" | "velocity" | "acceleration";

/** The axis' scale with the dividers as the chip just showed them; where it did not, as the server last knew them. */
export function liveScale(
  device: Schemas["DeviceInfo"],
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
  if (unit.startsWith("fCLK/(65536")) return "velocity";
  if (unit in PPS) return "velocity";
  return unit === "microsteps" ? "position" : null;
}

/** Velocities that a chip keeps as steps a second, and how many of them 1 in the register is. */
const PPS: Readonly<Record<string, number>> = { pps: 1, "1/256 pps": 1 / 256 };

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
  if (unit === "tCLK" && scale !== null) return [{ unit: "µs", perChip: 1e6 / scale.clockHz }];
  const motion = motionOf(unit);
  if (motion === null || scale === null) return [];
  const chip = PPS[unit] ?? factorOf("chip", scale, motion);
  if (chip === null) return [];
  return SHOWN[motion].flatMap((name) => {
    const steps = factorOf(name, scale, motion);
    return steps === null ? [] : [{ unit: symbolOf(name), perChip: chip / steps }];
  });
}

/** What a number comes to where no proportion tells: dividers as frequencies, step pulses as times. */
export function derived(bits: Pick<FieldRow | RegisterRow, "name" | "unit">, value: number, clockHz: number): string {
  if (bits.unit === "fCLK/32/2^n") return frequency(clockHz / 32 / 2 ** value);
  if (bits.name === "clk2_div") return frequency(clockHz / (2 * (value + 1)));
  if (bits.unit === "tCLK") return duration(value / clockHz);
  if (bits.unit === "128 tCLK") return duration((128 * value) / clockHz);
  return bits.unit === "16 tCLK" ? duration((16 * (value + 1)) / clockHz) : "";
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
