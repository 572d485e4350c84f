import type { Schemas } from "../../api/client";
import { type FieldRow, type RegisterRow, unpackField } from "./bits";
import type { Scale } from "./input";

/** What chip units of one axis depend on; null where it is not known now. */
export interface AxisContext {
  clockHz: number;
  pulseDiv: number | null;
  rampDiv: number | null;
  microstepsPerFullStep: number | null;
  fullStepsPerRev: number;
  gearRatio: number;
  travelMmPerRev: number | null;
}

type Reading = Schemas["RegisterReading"];

/** The dividers as the chip just showed them; where it did not, as the server last knew them. */
export function axisContext(
  device: Schemas["DeviceInfo"],
  axis: number,
  readings: readonly Reading[] | undefined,
): AxisContext | null {
  const info = device.axes[axis];
  if (!info) return null;
  const packed = readings?.find((reading) => reading.axis === axis && /^pulse_div_/i.test(reading.name));
  const fields = Object.fromEntries(
    Object.entries(packed?.fields ?? {}).map(([name, value]) => [name.toLowerCase(), value]),
  );
  return {
    clockHz: device.clock_hz,
    pulseDiv: fields.pulse_div ?? info.pulse_div,
    rampDiv: fields.ramp_div ?? info.ramp_div,
    microstepsPerFullStep: fields.usrs === undefined ? info.microsteps_per_full_step : 2 ** fields.usrs,
    fullStepsPerRev: info.full_steps_per_rev,
    gearRatio: info.gear_ratio,
    travelMmPerRev: info.travel_mm_per_rev,
  };
}

type Kind = "velocity" | "acceleration" | "position";

/** The unit column of the catalog tells what a number measures. */
export function kindOf(unit: string): Kind | null {
  if (unit.startsWith("fCLK^2/")) return "acceleration";
  if (unit.startsWith("fCLK/(65536")) return "velocity";
  return unit === "microsteps" ? "position" : null;
}

/** A short unit for beside the number; the catalog's formula is in the help. */
export function chipUnit(unit: string): string {
  const kind = kindOf(unit);
  if (kind === "position") return "µsteps";
  if (kind !== null) return "chip";
  return unit.startsWith("fCLK/32") ? "exp" : unit;
}

/** Physical units that are proportional to the chip's, most telling first. Sources: 001, 8.14 and 8.7. */
export function scalesOf(unit: string, context: AxisContext | null): Scale[] {
  const kind = kindOf(unit);
  if (kind === null || context === null) return [];
  let perChip = 1;
  if (kind === "velocity") {
    if (context.pulseDiv === null) return [];
    perChip = context.clockHz / 2 ** (16 + context.pulseDiv);
  } else if (kind === "acceleration") {
    if (context.pulseDiv === null || context.rampDiv === null) return [];
    perChip = context.clockHz ** 2 / 2 ** (29 + context.pulseDiv + context.rampDiv);
  }
  const per = { velocity: "/s", acceleration: "/s²", position: "" }[kind];
  const scales: Scale[] = kind === "position" ? [] : [{ unit: kind === "velocity" ? "pps" : "pps²", perChip }];
  if (context.microstepsPerFullStep === null) return scales;
  const turns = perChip / (context.microstepsPerFullStep * context.fullStepsPerRev * context.gearRatio);
  if (kind === "position") scales.push({ unit: "rev", perChip: turns }, { unit: "°", perChip: turns * 360 });
  else scales.push({ unit: kind === "velocity" ? "rpm" : "rpm/s", perChip: turns * 60 });
  if (context.travelMmPerRev !== null) scales.push({ unit: `mm${per}`, perChip: turns * context.travelMmPerRev });
  return scales;
}

/** What a number means where no proportion tells: dividers and step pulses as frequencies and times. */
export function derived(bits: Pick<FieldRow | RegisterRow, "name" | "unit">, value: number, clockHz: number): string {
  if (bits.unit === "fCLK/32/2^n") return frequency(clockHz / 32 / 2 ** value);
  if (bits.name === "clk2_div") return frequency(clockHz / (2 * (value + 1)));
  if (bits.unit === "16 tCLK") return `${number(((16 * (value + 1)) / clockHz) * 1e6)} µs`;
  return "";
}

/** p of the pair, or nothing for any other register. */
export function pairValue(row: RegisterRow, raw: number): string {
  if (!/^pmul_pdiv$/i.test(row.name)) return "";
  const part = (name: string) => row.fields.find((field) => field.name.toLowerCase() === name);
  const [pmul, pdiv] = [part("pmul"), part("pdiv")];
  if (!pmul || !pdiv) return "";
  // TMC428 counts pmul without its fixed leading one (7 bits), TMC4210 with it (8 bits).
  const mantissa = unpackField(raw, pmul) + (pmul.width === 7 ? 128 : 0);
  return `p ${number(mantissa / 2 ** (3 + unpackField(raw, pdiv)))}`;
}

function frequency(hertz: number): string {
  if (hertz >= 1e6) return `${number(hertz / 1e6)} MHz`;
  return hertz >= 1e3 ? `${number(hertz / 1e3)} kHz` : `${number(hertz)} Hz`;
}

/** Four figures, grouped, a true minus. */
export function number(value: number): string {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e9)) return value.toExponential(2).replace("-", "−");
  const decimals = size === 0 ? 0 : Math.max(0, Math.min(4, 3 - Math.floor(Math.log10(size))));
  return value.toLocaleString("en", { maximumFractionDigits: decimals, minimumFractionDigits: 0 }).replace("-", "−");
}

/** A chip value in its physical units: `1,907 pps · 8.94 rpm · 0.298 mm/s`. */
export function physicalText(value: number, scales: readonly Scale[]): string {
  return scales.map((scale) => `${number(value * scale.perChip)} ${scale.unit}`).join(" · ");
}
