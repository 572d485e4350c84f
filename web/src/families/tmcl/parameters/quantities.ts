import { compact, duration, withUnit } from "../../../lib/format";
import type { RegisterRow } from "../../../lib/rows/bits";
import type { Scale } from "../../../lib/rows/input";
import { motionOf as measured } from "../../../lib/rows/physical";
import { type AxisScale, factorOf, symbolOf } from "../../../lib/units";

type Motion = "position" | "velocity" | "acceleration";

const MOTIONS: Record<string, Motion> = { microsteps: "position", pps: "velocity", "pps^2": "acceleration" };
const PPS = { velocity: "pps", acceleration: "pps^2" } as const;
const SHOWN: Record<Motion, readonly string[]> = {
  position: ["rev", "deg", "mm"],
  velocity: ["rev_per_s", "rpm", "mm_per_s"],
  acceleration: ["rev_per_s2", "mm_per_s2"],
};

/** What a module's speeds and accelerations count in: AP 255. */
export type UnitMode = "pps" | "internal";

/**
 * How many pps (pps²) 1 is while the module counts in units of its driver chip: f / 2^24 and f² / 2^41, TMC5160 data
 * sheet 12.1.
 */
function internalUnit(motion: Motion, clockHz: number): number {
  if (motion === "position") return 1;
  return motion === "velocity" ? clockHz / 2 ** 24 : clockHz ** 2 / 2 ** 41;
}

/** What a number of a parameter measures: of a module with dividers its unit is a formula of theirs. */
function motionOf(row: RegisterRow): Motion | undefined {
  return MOTIONS[row.unit] ?? (isDivided(row) ? (measured(row.unit) ?? undefined) : undefined);
}

/** Whether speeds and accelerations count by dividers, which the axis knows. */
function isDivided(row: RegisterRow): boolean {
  return row.unit.startsWith("fCLK");
}

/** How many pps (pps²) 1 is; null while nobody knows the dividers. */
function unitOf(row: RegisterRow, motion: Motion, scale: AxisScale | null, mode: UnitMode, clockHz: number) {
  if (isDivided(row)) return scale === null ? null : factorOf("chip", scale, motion);
  return mode === "internal" ? internalUnit(motion, clockHz) : 1;
}

function stepsPer(unit: string, scale: AxisScale, motion: Motion): number | null {
  if (unit === "rev_per_s" || unit === "rev_per_s2") return factorOf("rev", scale, "position");
  return factorOf(unit, scale, motion);
}

const SYMBOL: Record<string, string> = { rev_per_s: "rps", rev_per_s2: "rps²" };

/** Units that are a plain multiple of something people know. */
const TIMES: Record<string, number> = { "32 us": 32e-6, "16.384 ms": 16.384e-3, "10 ms": 10e-3, ms: 1e-3 };

/** Physical units that are proportional to a parameter's number, most telling first; people may type them, too. */
export function scalesOf(row: RegisterRow, scale: AxisScale | null, mode: UnitMode, clockHz: number): Scale[] {
  const time = TIMES[row.unit];
  if (time !== undefined)
    return [
      { unit: "s", perChip: time },
      { unit: "ms", perChip: time * 1000 },
    ];
  if (row.unit === "1/255") return [{ unit: "%", perChip: 100 / 255 }];
  if (row.unit === "1/1024 turn") return [{ unit: "°", perChip: 360 / 1024 }];
  if (row.unit === "0.1 V") return [{ unit: "V", perChip: 0.1 }];
  if (row.unit === "degC") return [{ unit: "°C", perChip: 1 }];
  const motion = motionOf(row);
  if (motion === undefined) return [];
  const chip = unitOf(row, motion, scale, mode, clockHz);
  if (chip === null) return [];
  const counted = isDivided(row) || mode === "internal";
  const own = counted && motion !== "position" ? [{ unit: symbolOf(PPS[motion]), perChip: chip }] : [];
  if (scale === null) return own;
  return own.concat(
    SHOWN[motion].flatMap((name) => {
      const steps = stepsPer(name, scale, motion);
      return steps === null ? [] : [{ unit: SYMBOL[name] ?? symbolOf(name), perChip: chip / steps }];
    }),
  );
}

/** The short unit beside the number; none where the physical value says it all. */
export function unitText(row: RegisterRow, mode: UnitMode): string {
  const motion = motionOf(row);
  if (motion === "velocity" || motion === "acceleration")
    return mode === "internal" || isDivided(row) ? symbolOf("chip") : symbolOf(row.unit);
  if (motion === "position") return symbolOf("microsteps");
  if (["32 us", "16.384 ms", "10 ms"].includes(row.unit)) return `× ${row.unit.replace("us", "µs")}`;
  if (row.unit === "degC") return "°C";
  return row.unit.startsWith("0.1 ") ? `× ${row.unit}` : row.unit;
}

/** The peak coil current with every scaler at its most [A]: 3 A RMS, PD42-1241 manual 1.2. */
export const FULL_SCALE_A = 4.2;

/** A current of AP 6 or 7: share of the full scale, and the peak of the coil current. The driver makes 32 steps of it. */
export function currentText(value: number, globalScaler: number | null): string {
  const share = compact((100 * value) / 255, 3, "%");
  if (globalScaler === null) return share;
  const scaler = globalScaler === 0 ? 1 : globalScaler / 256;
  const amperes = (FULL_SCALE_A * scaler * (Math.floor(value / 8) + 1)) / 32;
  return `${withUnit(amperes, "A", 3)} peak · ${share}`;
}

/** What numbers mean on this axis now. */
export interface Context {
  scale: AxisScale | null;
  mode: UnitMode;
  clockHz: number;
  /** AP 178; null while it is not known */
  globalScaler: number | null;
}

/** A parameter's number as what it means; empty where the number says it all. */
export function meaningOf(row: RegisterRow, value: number, context: Context): string {
  if (row.unit === "1/255") return currentText(value, context.globalScaler);
  if (row.unit === "1/256") return value === 0 ? "full scale" : compact((100 * value) / 256, 3, "%");
  if (TIMES[row.unit] !== undefined) return duration(value * (TIMES[row.unit] ?? 0));
  return scalesOf(row, context.scale, context.mode, context.clockHz)
    .map((scale) => withUnit(value * scale.perChip, scale.unit, 4))
    .join(" · ");
}

/** What may be written, in the units that the module counts in now. */
export function rangeOf(row: RegisterRow, mode: UnitMode): { minimum: number; maximum: number } {
  const [low, high] = (mode === "internal" ? row.internal_range : null) ?? [];
  return { minimum: low ?? row.minimum, maximum: high ?? row.maximum };
}

/** The mode that AP 255 tells; until it is known, what the manual calls the usual one. */
export function unitModeOf(value: number | undefined): UnitMode {
  return value === 0 ? "internal" : "pps";
}
