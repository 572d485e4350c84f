import type { Schemas } from "../../../api/client";

export type Scaling = Schemas["CurrentScalingResult"];
export type Span = Scaling["spans"][number];

/** Fields of the register, by the phase in which each holds. */
export const SCALES = [
  { field: "is_agtat", title: "Accelerating", note: "above a_threshold" },
  { field: "is_aleat", title: "Moving", note: "up to a_threshold" },
  { field: "is_v0", title: "At rest", note: "after 255 ramp ticks" },
] as const;

export type ScaleField = (typeof SCALES)[number]["field"];
export type Codes = Record<ScaleField, number> & { a_threshold: number };

/** What a chip has after power-on: full scale always. */
export const AFTER_POWER_ON: Codes = { is_agtat: 0, is_aleat: 0, is_v0: 0, a_threshold: 0 };

/** Eighths of full scale of a code: 0 stands for all of it (DS-TMC428 Table 8-1). */
export function eighthsOf(code: number): number {
  return code === 0 ? 8 : code;
}

/** The code of a share of full scale, the nearest that there is: an eighth at least. */
export function codeOf(eighths: number): number {
  const whole = Math.min(8, Math.max(1, Math.round(eighths)));
  return whole === 8 ? 0 : whole;
}

/** The current over time as corners of a line [s], [% of full scale, or A]. */
export function currentLine(spans: readonly Span[], fullScaleA: number | null): { x: number[]; y: number[] } {
  const per = fullScaleA === null ? 12.5 : fullScaleA / 8;
  const x: number[] = [];
  const y: number[] = [];
  for (const span of spans) {
    x.push(span.start_s, span.end_s);
    y.push(span.eighths * per, span.eighths * per);
  }
  return { x, y };
}

/** How many of the microsteps of a full step are still told apart: scaling takes DAC levels away (DS-TMC428 8.9). */
export function effectiveMicrosteps(usrs: number, code: number): number {
  return (2 ** usrs * eighthsOf(code)) / 8;
}
