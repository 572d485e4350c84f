/** Steps of a macro as a form has them: which fields each kind has, and what is written in them read back. */
import type { Schemas } from "../../api/client";

export type Step = Schemas["MacroDocument"]["steps"][number];
type Kind = Step["do"];
export type Raw = Readonly<Record<string, unknown>>;

export interface StepField {
  key: string;
  label: string;
  kind: "number" | "whole" | "text" | "list" | "choice" | "to" | "step";
  unit?: string;
  min?: number;
  max?: number;
  choices?: Readonly<Record<string, string>>;
  /** it may be left empty, and is then of no axis */
  optional?: true;
}

const AXIS: StepField = { key: "axis", label: "Axis", kind: "whole", min: 0, max: 31 };
const AT_MOST: StepField = { key: "at_most_s", label: "At most", kind: "number", unit: "s", max: 3600 };
const same = (...names: string[]) => Object.fromEntries(names.map((name) => [name, name]));
const unitOf = (...names: string[]): StepField => ({
  key: "unit",
  label: "Unit",
  kind: "choice",
  choices: same(...names),
});

/** Each kind of step: what it is called, what a new one says, and its fields. */
export const KINDS: Readonly<Record<Kind, { title: string; first: Step; fields: readonly StepField[] }>> = {
  move: {
    title: "Move",
    first: { do: "move", axis: 0, target: 0, relative: false, unit: "microsteps" },
    fields: [
      AXIS,
      { key: "relative", label: "Way", kind: "choice", choices: { false: "to", true: "by" } },
      { key: "target", label: "Target", kind: "number" },
      unitOf("microsteps", "fullsteps", "rev", "deg", "rad", "mm"),
    ],
  },
  "wait position": {
    title: "Wait until it is there",
    first: { do: "wait position", axis: 0, at_most_s: 60 },
    fields: [AXIS, AT_MOST],
  },
  rotate: {
    title: "Rotate",
    first: { do: "rotate", axis: 0, velocity: 0, unit: "pps" },
    fields: [
      AXIS,
      { key: "velocity", label: "Velocity", kind: "number" },
      unitOf("pps", "chip", "fullsteps_per_s", "rps", "rpm", "rad_per_s", "mm_per_s"),
    ],
  },
  stop: {
    title: "Stop",
    first: { do: "stop", axis: 0, mode: "ramp" },
    fields: [
      AXIS,
      { key: "mode", label: "How", kind: "choice", choices: { ramp: "by the ramp", immediate: "at once" } },
    ],
  },
  wait: {
    title: "Wait",
    first: { do: "wait", seconds: 1 },
    fields: [{ key: "seconds", label: "Time", kind: "number", unit: "s", min: 0, max: 3600 }],
  },
  "wait channel": {
    title: "Wait for a channel",
    first: { do: "wait channel", channel: "velocity.0", when: "below", value: 1, at_most_s: 60 },
    fields: [
      { key: "channel", label: "Channel", kind: "text" },
      { key: "when", label: "Is", kind: "choice", choices: same("above", "below") },
      { key: "value", label: "Value", kind: "number" },
      AT_MOST,
    ],
  },
  write: {
    title: "Write",
    first: { do: "write", name: "", axis: 0, value: 0 },
    fields: [
      { key: "name", label: "Register", kind: "text" },
      { ...AXIS, optional: true },
      { key: "to", label: "Value, or fields: toff 3, tbl 2", kind: "to" },
    ],
  },
  "record start": {
    title: "Begin to record",
    first: { do: "record start", name: "macro", channels: ["position.0"], rate_hz: 200 },
    fields: [
      { key: "name", label: "Name", kind: "text" },
      { key: "channels", label: "Channels", kind: "list" },
      { key: "rate_hz", label: "Rate", kind: "number", unit: "Hz", min: 1, max: 1000 },
    ],
  },
  "record stop": { title: "End the recording", first: { do: "record stop" }, fields: [] },
  profile: {
    title: "Apply a profile",
    first: { do: "profile", profile: 1, name: "" },
    fields: [{ key: "profile", label: "Number of the profile", kind: "whole", min: 1 }],
  },
};

export function kindOf(step: Step): (typeof KINDS)[Kind] | undefined {
  return Object.hasOwn(KINDS, step.do) ? KINDS[step.do] : undefined;
}

const WHOLE = /^[+-]?(0x[0-9a-f]+|\d+)$/i;
const wholeOf = (text: string) => (WHOLE.test(text) ? Number(text.replace(/^[+]/, "")) : Number.NaN);

const WHOLE_STEP: StepField = { key: "step", label: "A step of a kind that is not known here, as JSON", kind: "step" };

/** Those of its kind; a step of a kind that is not known here is one text. */
export function fieldsOf(step: Step): readonly StepField[] {
  return kindOf(step)?.fields ?? [WHOLE_STEP];
}

/** What a field of a step says, as text. */
export function shown(step: Step, { key, kind }: StepField): string {
  if (kind === "step") return JSON.stringify(step);
  const raw = step as unknown as Raw;
  if (kind === "to") {
    if (raw.fields === undefined || raw.fields === null) return String(raw.value ?? "");
    return Object.entries(raw.fields)
      .map(([name, value]) => `${name} ${value}`)
      .join(", ");
  }
  const value = raw[key];
  return Array.isArray(value) ? value.join(", ") : value === null || value === undefined ? "" : String(value);
}

/** The step with another text in a field; null where that says nothing that could stand there. */
export function written(step: Step, field: StepField, text: string): Step | null {
  if (field.kind === "step") {
    const [next = null, ...more] = stepsOf(`[${text}]`) ?? [];
    return more.length === 0 ? next : null;
  }
  const value = readField(field, text.trim());
  if (value === null) return null;
  const { value: _, fields: __, ...others } = step as unknown as Record<string, unknown>;
  const base = field.kind === "to" ? others : (step as unknown as Raw);
  return { ...base, ...value } as unknown as Step;
}

function readField({ key, kind, optional, min, max }: StepField, text: string): Raw | null {
  if (kind === "text") return { [key]: text };
  if (kind === "list") return { [key]: text.split(/[\s,]+/).filter(Boolean) };
  if (kind === "choice") return { [key]: text === "true" ? true : text === "false" ? false : text };
  if (kind === "to") {
    const whole = wholeOf(text);
    if (Number.isSafeInteger(whole)) return { value: whole };
    const pairs = text.split(",").map((pair) => pair.trim().split(/[\s=:]+/));
    const fields = pairs.map(([name = "", value = "", more]) => [
      name,
      more === undefined ? wholeOf(value) : Number.NaN,
    ]);
    return fields.every(([name, value]) => name !== "" && Number.isSafeInteger(value))
      ? { fields: Object.fromEntries(fields) }
      : null;
  }
  if (text === "") return optional ? { [key]: null } : null;
  const number = kind === "whole" ? wholeOf(text) : Number(text.replace(",", "."));
  const fits = Number.isFinite(number) && number >= (min ?? -Infinity) && number <= (max ?? Infinity);
  return fits ? { [key]: number } : null;
}

/** One a line. */
export function linesOf(steps: readonly Step[]): string {
  return steps.length === 0 ? "[]" : `[\n${steps.map((step) => ` ${JSON.stringify(step)}`).join(",\n")}\n]`;
}

/** Steps out of such lines; null where they are none. What a step says is judged by the server. */
export function stepsOf(text: string): Step[] | null {
  try {
    const raw: unknown = JSON.parse(text);
    const whole = Array.isArray(raw) && raw.every((each) => typeof each?.do === "string");
    return whole ? (raw as Step[]) : null;
  } catch {
    return null;
  }
}

/** With the step at `from` at the place `to`. */
export function moved(steps: readonly Step[], from: number, to: number): Step[] {
  const next = steps.filter((_, index) => index !== from);
  next.splice(to, 0, ...steps.slice(from, from + 1));
  return next;
}
