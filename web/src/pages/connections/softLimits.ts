import type { Schemas } from "../../api/client";
import { compact, withUnit } from "../../lib/format";
import { type AxisScale, fromSteps } from "../../lib/units";
import { type Limits, numberOf, numberProblem, said } from "./limits";
import type { Model } from "./models";

export type SoftLimits = Schemas["AxisLimits-Output"];

/** What is typed of an axis's soft limits; empty text is no limit. */
export interface SoftLimitDraft {
  positionMin: string;
  positionMax: string;
  velocity: string;
  acceleration: string;
  current: string;
  senseOhm: string;
  fullScaleA: string;
}

export const NO_LIMITS: SoftLimitDraft = {
  positionMin: "",
  positionMax: "",
  velocity: "",
  acceleration: "",
  current: "",
  senseOhm: "",
  fullScaleA: "",
};

interface Part {
  part: keyof SoftLimitDraft;
  key: keyof SoftLimits;
  label: string;
  unit: string;
  limits: Limits;
}

const POSITION = { minimum: -(2 ** 31), maximum: 2 ** 31 - 1, integer: true, fallback: null } as const;
const RATE = { minimum: 0, above: true, maximum: 1e12, fallback: null } as const;
const SMALL = { minimum: 0, above: true, maximum: 1000, fallback: null } as const;

const EVERY: Part[] = [
  { part: "positionMin", key: "position_min", label: "From", unit: "µsteps", limits: POSITION },
  { part: "positionMax", key: "position_max", label: "To", unit: "µsteps", limits: POSITION },
  { part: "velocity", key: "velocity_max_pps", label: "Speed", unit: "pps", limits: RATE },
  { part: "acceleration", key: "acceleration_max_pps2", label: "Acceleration", unit: "pps²", limits: RATE },
  { part: "current", key: "current_max_a", label: "Current", unit: "A rms", limits: RATE },
  { part: "senseOhm", key: "sense_resistor_ohm", label: "Sense resistor", unit: "Ω", limits: SMALL },
  { part: "fullScaleA", key: "current_full_scale_a", label: "Full scale", unit: "A rms", limits: SMALL },
];

/** What makes amperes of a model's current scales; none where it sets no current. */
function amperesBy(model: Model): "senseOhm" | "fullScaleA" | null {
  const by = { "": null, sense_resistor: "senseOhm", full_scale: "fullScaleA" } as const;
  return by[model.current_scale];
}

/** The fields that a model can keep. */
export function partsOf(model: Model): Part[] {
  const by = amperesBy(model);
  const left = new Set<string>(["senseOhm", "fullScaleA"].filter((part) => part !== by));
  if (by === null) left.add("current");
  return EVERY.filter(({ part }) => !left.has(part));
}

export function limitDraftOf(limits: SoftLimits | undefined): SoftLimitDraft {
  if (limits === undefined) return NO_LIMITS;
  return Object.fromEntries(EVERY.map(({ part, key }) => [part, said(limits[key])])) as unknown as SoftLimitDraft;
}

/** As it is sent: what the model has no field for stays as it was. */
export function limitsOf(draft: SoftLimitDraft): SoftLimits {
  return Object.fromEntries(
    EVERY.map(({ part, key }) => [key, numberOf(draft[part]) ?? null]),
  ) as unknown as SoftLimits;
}

/** Every problem of one axis's limits, by its field. */
export function limitProblems(draft: SoftLimitDraft, model: Model): [keyof SoftLimitDraft, string][] {
  const found: [keyof SoftLimitDraft, string][] = [];
  for (const { part, limits } of partsOf(model)) {
    const problem = numberProblem(draft[part], limits);
    if (problem !== null) found.push([part, problem]);
  }
  const [from, to] = [numberOf(draft.positionMin), numberOf(draft.positionMax)];
  if (from !== undefined && to !== undefined && from > to)
    found.push(["positionMax", `Wanted: not below ${compact(from)}`]);
  const by = amperesBy(model);
  if (numberOf(draft.current) !== undefined && by !== null && draft[by].trim() === "")
    found.push([by, "Wanted, to make amperes of the chip's current scale"]);
  return found;
}

/** Limits in the units of what the axis moves, as far as it is known; empty where that says no more than the fields. */
export function inMechanics(draft: SoftLimitDraft, scale: AxisScale | undefined): string {
  if (scale === undefined) return "";
  const [place, rate] = scale.travelMmPerRev === null ? ["deg", "rpm"] : ["mm", "mm_per_s"];
  const shown = (text: string, unit: string, motion: "position" | "velocity") => {
    const value = numberOf(text);
    const own = value === undefined ? Number.NaN : fromSteps(value, unit, scale, motion);
    return Number.isNaN(own) ? null : withUnit(own, unit);
  };
  const [from, to] = [shown(draft.positionMin, place, "position"), shown(draft.positionMax, place, "position")];
  const speed = shown(draft.velocity, rate, "velocity");
  return [from === null ? "" : `from ${from}`, to === null ? "" : `to ${to}`, speed === null ? "" : `at most ${speed}`]
    .filter((text) => text !== "")
    .join(", ");
}

/** Whether anything is limited. */
export function limited(draft: SoftLimitDraft): boolean {
  return EVERY.some(({ part }) => part !== "senseOhm" && part !== "fullScaleA" && draft[part].trim() !== "");
}
