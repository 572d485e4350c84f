import { rounded } from "../../../lib/format";
import type { Kind } from "../../../lib/ramp/answer";
import type { Mode } from "../../../lib/ramp/DesignPlots";
import type { Preset } from "../../../lib/ramp/RampRegisters";

/**
 * The registers of a SixPoint ramp as they are wished for, in pps, pps² and seconds; `registers.ts` says what the chip
 * can hold of that.
 */
export interface Design {
  vstart: number;
  a1: number;
  v1: number;
  amax: number;
  vmax: number;
  dmax: number;
  d1: number;
  vstop: number;
  tzerowait: number;
}

export type Parameter = keyof Design;
/** Those that are seen on a plot. */
export type Drawn = Exclude<Parameter, "tzerowait">;

export const PARAMETERS: readonly Parameter[] = [
  "vstart",
  "a1",
  "v1",
  "amax",
  "vmax",
  "dmax",
  "d1",
  "vstop",
  "tzerowait",
];

export const KIND: Record<Drawn, Kind> = {
  vstart: "velocity",
  a1: "acceleration",
  v1: "velocity",
  amax: "acceleration",
  vmax: "velocity",
  dmax: "acceleration",
  d1: "acceleration",
  vstop: "velocity",
};

export const MEANING: Record<Parameter, string> = {
  vstart: "velocity that is skipped at the start",
  a1: "acceleration from VSTART to V1",
  v1: "velocity at which A1 hands over to AMAX, and DMAX to D1; 0 leaves A1 and D1 out",
  amax: "acceleration from V1 to VMAX; in velocity mode the only one",
  vmax: "highest velocity",
  dmax: "deceleration from VMAX to V1",
  d1: "deceleration from V1 to VSTOP",
  vstop: "velocity that is skipped at the stop",
  tzerowait: "rest before turning round, or before the next move",
};

/** Which values go together: braking as speeding up, or each its own. */
export type Lock = "mirrored" | "free";

const TWIN: Partial<Record<Parameter, Parameter>> = { a1: "d1", d1: "a1", amax: "dmax", dmax: "amax" };

/** The design with one value changed, and with it the one that the lock ties to it. */
export function changed(design: Design, parameter: Parameter, value: number, lock: Lock): Design {
  const next = { ...design, [parameter]: value };
  const twin = TWIN[parameter];
  if (lock === "mirrored" && twin !== undefined) next[twin] = value;
  return next;
}

/** The design as the lock wants it: what accelerates decides. */
export function locked(design: Design, lock: Lock): Design {
  return lock === "free" ? design : { ...design, dmax: design.amax, d1: design.a1 };
}

export function lockOf({ a1, d1, amax, dmax }: Design): Lock {
  return a1 === d1 && amax === dmax ? "mirrored" : "free";
}

/** Nearly four turns a second of a 200-step motor at 256 microsteps; steeper below half of that. */
export const START: Design = {
  vstart: 0,
  a1: 1_500_000,
  v1: 100_000,
  amax: 750_000,
  vmax: 200_000,
  dmax: 750_000,
  d1: 1_500_000,
  vstop: 10,
  tzerowait: 0,
};

/** Microsteps of a slope between rest and VMAX that is `first` up to `knee`, then `second`. */
function slope(start: number, knee: number, end: number, first: number, second: number): number {
  const mid = Math.min(Math.max(knee, start), end);
  const part = (from: number, to: number, rate: number) => (to > from ? (to ** 2 - from ** 2) / (2 * rate) : 0);
  return part(start, mid, first) + part(mid, end, second);
}

/** A distance on which every phase can be seen: one and a half times both slopes. */
export function showingDistance({ vstart, a1, v1, amax, vmax, dmax, d1, vstop }: Design): number {
  const way = slope(vstart, v1, vmax, a1, amax) + slope(vstop, v1, vmax, d1, dmax);
  const steps = Number.isFinite(way) && way > 0 ? 1.5 * way : vmax;
  return Math.min(2 ** 30, Math.max(100, rounded(steps, 2)));
}

/** Three leading digits, as a person would choose them. */
function leading(value: number): number {
  return value > 0 && Number.isFinite(value) ? rounded(value, 3) : 0;
}

/** Shapes for the velocity and acceleration that are set; each keeps VMAX and AMAX. */
export const PRESETS: readonly Preset<Design>[] = [
  {
    name: "Trapezoid",
    text: "V1 = 0: AMAX and DMAX alone, equal; D1 still above 0",
    of: (design) => ({ ...design, vstart: 0, v1: 0, a1: design.amax, d1: design.amax, dmax: design.amax, vstop: 10 }),
  },
  {
    name: "Torque at low speed",
    text: "twice AMAX up to half of VMAX, where a motor has torque to spare",
    of: (design) => steps(design, 0.5, 2),
  },
  {
    name: "Soft start and stop",
    text: "a third of AMAX below a fifth of VMAX: less jerk where a load swings",
    of: (design) => steps(design, 0.2, 1 / 3),
  },
  {
    name: "Over the resonance",
    text: "starts and stops at a tenth of VMAX, above the speeds at which it rings",
    of: (design) => {
      const speed = leading(design.vmax / 10);
      return { ...steps(design, 0.5, 1.5), vstart: speed, vstop: speed };
    },
  },
  {
    name: "Soft landing",
    text: "quick away, half as hard braking, a fifth of that at the end",
    of: (design) => ({
      ...steps(design, 0.3, 1.5),
      dmax: leading(design.amax / 2),
      d1: leading(design.amax / 10),
    }),
  },
];

function steps(design: Design, knee: number, factor: number): Design {
  const rate = leading(design.amax * factor);
  return {
    ...design,
    vstart: 0,
    v1: leading(design.vmax * knee),
    a1: rate,
    d1: rate,
    dmax: design.amax,
    vstop: 10,
  };
}

/** The same limits without the first and the last slope: what the six points are compared with. */
export function trapezoidOf(design: Design): Design {
  return { ...design, v1: 0 };
}

/** The parameters of POST /calc/ramp, model "sixpoint"; with a clock the answer tells what the chip makes of them. */
export function rampParameters(
  design: Design,
  mode: Mode,
  way: number,
  clockHz?: number,
): Record<string, number | string> {
  const { tzerowait, ...values } = design;
  return {
    ...values,
    t_zero_wait_s: tzerowait,
    ...(clockHz === undefined ? {} : { clock_hz: clockHz }),
    ...(mode === "velocity" ? { ramp_mode: "velocity", v_target: way < 0 ? -design.vmax : design.vmax } : {}),
  };
}

/** The parameters that have a part in a ramp of that mode. */
export function used(mode: Mode): readonly Drawn[] {
  if (mode === "velocity") return ["vstart", "amax", "vmax"];
  return ["vstart", "a1", "v1", "amax", "vmax", "dmax", "d1", "vstop"];
}
