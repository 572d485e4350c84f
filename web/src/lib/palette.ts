/**
 * The colour of a trace says of what kind it is, on every page, legend and view; the form of its line says it again.
 * Red is none of them: it stands for stop and faults alone. Two shades, for light and dark ground, also legible as text.
 */
export const KINDS = {
  measured: { light: "#0068a8", dark: "#56b4e9" },
  predicted: { light: "#a86400", dark: "#e69f00" },
  target: { light: "#6b7280", dark: "#c2c7cf" },
  encoder: { light: "#6a0f5c", dark: "#e65fb0" },
  velocity: { light: "#008060", dark: "#a6e36a" },
  load: { light: "#4b2fa3", dark: "#8f7bff" },
  current: { light: "#5c5200", dark: "#f0e442" },
  derived: { light: "#1b1f24", dark: "#ffffff" },
} as const;
export type Kind = keyof typeof KINDS;

interface Trace {
  kind: Kind;
  /** the form of its line where that is not its kind's */
  dash?: number[];
}

const ASIDE = [5, 3];
const TRACES = {
  position: { kind: "measured" },
  target_position: { kind: "target" },
  predicted_position: { kind: "predicted" },
  velocity: { kind: "velocity" },
  target_velocity: { kind: "target" },
  predicted_velocity: { kind: "predicted" },
  acceleration: { kind: "velocity", dash: [2, 2] },
  jerk: { kind: "derived" },
  /** what a formula makes of others */
  derived: { kind: "derived" },
  residual: { kind: "derived" },
  // an encoder and what it deviates by are one colour, the outer one's dashed
  encoder_position: { kind: "encoder" },
  deviation: { kind: "encoder" },
  external_encoder_position: { kind: "encoder", dash: ASIDE },
  external_deviation: { kind: "encoder", dash: ASIDE },
  encoder_velocity: { kind: "encoder" },
  measured_speed: { kind: "encoder" },
  load_value: { kind: "load" },
  load_angle: { kind: "load" },
  actual_current_scale: { kind: "current" },
  current_scale: { kind: "current" },
  current_a: { kind: "current" },
  current_b: { kind: "current", dash: ASIDE },
  // of the 3D view, where no line is dashed
  coil_b: { kind: "predicted" },
  phase_a: { kind: "current" },
  phase_b: { kind: "current", dash: ASIDE },
  switch_left: { kind: "measured" },
  switch_right: { kind: "velocity" },
  switch_reference: { kind: "predicted" },
  switch_home: { kind: "load" },
  position_reached: { kind: "target" },
} satisfies Record<string, Trace>;
export type Quantity = keyof typeof TRACES;

/** Of what has no kind of its own: the same for a name on every page. */
const OTHERS: readonly Kind[] = ["velocity", "load", "predicted", "encoder", "measured", "current", "derived"];

function otherOf(name: string): Trace {
  let sum = 0;
  for (const character of name) sum = (31 * sum + (character.codePointAt(0) ?? 0)) >>> 0;
  return { kind: OTHERS[sum % OTHERS.length] ?? "velocity" };
}

function traceOf(quantity: string): Trace {
  return quantity in TRACES ? TRACES[quantity as Quantity] : otherOf(quantity);
}

/** The colour of a quantity, or of any register or parameter by its name. */
export function colorOf(quantity: Quantity | (string & {}), scheme: "light" | "dark"): string {
  return KINDS[traceOf(quantity).kind][scheme];
}

/** Colour and form of a quantity's line, to be spread into a series of a plot. */
export function lineOf(
  quantity: Quantity | (string & {}),
  scheme: "light" | "dark",
): { color: string; dash?: number[] } {
  const { kind, dash = FORMS[kind] } = traceOf(quantity);
  return { color: KINDS[kind][scheme], ...(dash ? { dash } : {}) };
}

/** Most lines are solid. What was foreseen is a broad pale band where the measured line lies on it: the scope's. */
const FORMS: Partial<Record<Kind, number[]>> = { target: [4, 3], derived: [6, 2] };
