import { rounded } from "../../../lib/format";
import type { Kind } from "../../../lib/ramp/answer";
import type { Mode } from "../../../lib/ramp/DesignPlots";
import type { Preset } from "../../../lib/ramp/RampRegisters";

/** The registers of an S-ramp, in pps, pps² and pps³: wished values; the calculator says what registers make of them. */
export interface Design {
  vmax: number;
  amax: number;
  dmax: number;
  bow1: number;
  bow2: number;
  bow3: number;
  bow4: number;
  vstart: number;
  vstop: number;
  astart: number;
  dfinal: number;
  vbreak: number;
}

export type Parameter = keyof Design;

export const KIND: Record<Parameter, Kind> = {
  vmax: "velocity",
  amax: "acceleration",
  dmax: "acceleration",
  bow1: "jerk",
  bow2: "jerk",
  bow3: "jerk",
  bow4: "jerk",
  vstart: "velocity",
  vstop: "velocity",
  astart: "acceleration",
  dfinal: "acceleration",
  vbreak: "velocity",
};

export const MEANING: Record<Parameter, string> = {
  vmax: "highest velocity",
  amax: "highest acceleration",
  dmax: "highest deceleration",
  bow1: "how fast acceleration grows at the start",
  bow2: "how fast it falls before VMAX",
  bow3: "how fast deceleration grows after VMAX",
  bow4: "how fast it falls before the stop",
  vstart: "velocity that is skipped at the start",
  vstop: "velocity that is skipped at the stop",
  astart: "acceleration at the start",
  dfinal: "deceleration at the stop",
  vbreak: "velocity at which ASTART and DFINAL hand over to AMAX and DMAX",
};

/** Which values go together: all bows one and DMAX as AMAX; the same slope up and down; or each its own. */
export type Lock = "equal" | "mirrored" | "free";
export type Shape = "s" | "trapezoid" | "hold";

export interface Options {
  mode: Mode;
  shape: Shape;
  /** GENERAL_CONF bits 0 to 2 */
  useAstart: boolean;
  directAcceleration: boolean;
  directBow: boolean;
}

const MIRRORED: Partial<Record<Parameter, Parameter>> = {
  amax: "dmax",
  dmax: "amax",
  bow1: "bow4",
  bow4: "bow1",
  bow2: "bow3",
  bow3: "bow2",
};
const BOWS = ["bow1", "bow2", "bow3", "bow4"] as const;

/** The design with one value changed, and with it those that the lock ties to it. */
export function changed(design: Design, parameter: Parameter, value: number, lock: Lock): Design {
  const next = { ...design, [parameter]: value };
  if (lock === "free") return next;
  if (lock === "equal" && KIND[parameter] === "jerk") for (const bow of BOWS) next[bow] = value;
  const twin = MIRRORED[parameter];
  if (twin !== undefined) next[twin] = value;
  return next;
}

/** The design as the lock wants it: what accelerates decides. */
export function locked(design: Design, lock: Lock): Design {
  if (lock === "free") return design;
  const { amax, bow1, bow2 } = design;
  if (lock === "equal") return { ...design, dmax: amax, bow2: bow1, bow3: bow1, bow4: bow1 };
  return { ...design, dmax: amax, bow3: bow2, bow4: bow1 };
}

/** The strictest lock that a design keeps to. */
export function lockOf(design: Design): Lock {
  const { amax, dmax, bow1, bow2, bow3, bow4 } = design;
  if (amax !== dmax || bow1 !== bow4 || bow2 !== bow3) return "free";
  return bow1 === bow2 ? "equal" : "mirrored";
}

/** The bow with which a slope just touches AMAX and B12 takes no time: the fastest slopes of DS-TMC4361 8.2. */
export function touchingBow(design: Pick<Design, "vmax" | "amax">): number {
  return leading(design.amax ** 2 / design.vmax);
}

/** Three leading digits, as a person would choose them. */
export function leading(value: number): number {
  return value > 0 && Number.isFinite(value) ? rounded(value, 3) : 0;
}

/** Nearly eight turns a second of a 200-step motor at 256 microsteps, within four tenths of a second. */
export const START: Design = {
  vmax: 400_000,
  amax: 2_000_000,
  dmax: 2_000_000,
  bow1: 10_000_000,
  bow2: 10_000_000,
  bow3: 10_000_000,
  bow4: 10_000_000,
  vstart: 0,
  vstop: 0,
  astart: 0,
  dfinal: 0,
  vbreak: 0,
};

export const OPTIONS: Options = {
  mode: "position",
  shape: "s",
  useAstart: false,
  directAcceleration: false,
  directBow: false,
};

/** A distance on which every phase can be seen: one and a half times both slopes. */
export function showingDistance({ vmax, amax, dmax, bow1, bow4 }: Design): number {
  const slope = (limit: number, bow: number) => vmax / limit + Math.min(limit, Math.sqrt(vmax * bow)) / bow;
  const steps = 0.75 * vmax * (slope(amax, bow1) + slope(dmax, bow4));
  return Math.min(2 ** 30, Math.max(100, rounded(steps, 2)));
}

function bows(design: Design, factors: readonly [number, number, number, number]): Design {
  const bow = touchingBow(design);
  const [bow1, bow2, bow3, bow4] = factors.map((factor) => leading(bow * factor)) as [number, number, number, number];
  return { ...design, bow1, bow2, bow3, bow4, vstart: 0, vstop: 0, astart: 0, dfinal: 0 };
}

/** Shapes for the velocity and acceleration that are set; each keeps VMAX and AMAX. */
export const PRESETS: readonly Preset<Design>[] = [
  {
    name: "Touching AMAX",
    text: "every bow AMAX²/VMAX: no time at AMAX, the fastest slope for its jerk",
    of: (design) => bows({ ...design, dmax: design.amax }, [1, 1, 1, 1]),
  },
  {
    name: "Smooth",
    text: "bows a quarter of that: half the acceleration, little to excite a resonance",
    of: (design) => bows({ ...design, dmax: design.amax }, [0.25, 0.25, 0.25, 0.25]),
  },
  {
    name: "Brisk",
    text: "bows five times that: long stretches of constant acceleration",
    of: (design) => bows({ ...design, dmax: design.amax }, [5, 5, 5, 5]),
  },
  {
    name: "High speed",
    text: "acceleration falls slowly towards VMAX, where the motor has little torque left",
    of: (design) => bows({ ...design, dmax: design.amax }, [8, 0.6, 0.6, 8]),
  },
  {
    name: "Soft landing",
    text: "quick away, gentle into the target",
    of: (design) => bows({ ...design, dmax: leading(design.amax / 2) }, [4, 4, 2, 0.2]),
  },
  {
    name: "Nearly a trapezoid",
    text: "bows a hundred times that",
    of: (design) => bows({ ...design, dmax: design.amax }, [100, 100, 100, 100]),
  },
];

const ACCELERATION_MOST = 2 ** 22 - 0.25;
const BOW_MOST = 2 ** 24 - 1;

/** The options with direct units where the registers could not hold the design without (DS-TMC4361 8.2.3). */
export function withRoom(options: Options, design: Design): Options {
  const { amax, dmax, astart, dfinal } = design;
  return {
    ...options,
    directAcceleration: options.directAcceleration || Math.max(amax, dmax, astart, dfinal) > ACCELERATION_MOST,
    directBow: options.directBow || BOWS.some((bow) => design[bow] > BOW_MOST),
  };
}

/** The parameters of POST /calc/ramp, model "s_ramp": what the registers will hold is what is calculated with. */
export function rampParameters(
  design: Design,
  options: Options,
  clockHz: number,
  way: number,
): Record<string, number | string> {
  const { vbreak, ...registers } = design;
  return {
    ...registers,
    ...(options.shape === "s" ? {} : { shape: options.shape }),
    ...(options.shape === "trapezoid" ? { vbreak } : {}),
    ramp_mode: options.mode,
    ...(options.mode === "velocity" ? { v_target: way < 0 ? -design.vmax : design.vmax } : {}),
    use_astart_and_vstart: options.useAstart ? 1 : 0,
    direct_acc_val_en: options.directAcceleration ? 1 : 0,
    direct_bow_val_en: options.directBow ? 1 : 0,
    rounding: "registers",
    clock_hz: clockHz,
  };
}

/** The parameters that have a part in a ramp of that shape. */
export function used(options: Options): readonly Parameter[] {
  if (options.shape === "hold") return ["vmax"];
  if (options.shape === "trapezoid") return ["vmax", "amax", "dmax", "vstart", "vstop", "vbreak", "astart", "dfinal"];
  return ["vmax", "amax", "dmax", "bow1", "bow2", "bow3", "bow4", "vstart", "astart", "vstop", "dfinal"];
}
