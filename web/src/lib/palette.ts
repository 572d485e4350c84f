/**
 * A quantity keeps its colour on every page, legend and view. Okabe and Ito's palette, which colour-blind people
 * can tell apart, without its vermilion: red stands for stop and faults alone. Two shades, for light and dark ground.
 */
export type Quantity =
  | "position"
  | "target_position"
  | "predicted_position"
  | "velocity"
  | "target_velocity"
  | "predicted_velocity"
  | "acceleration"
  | "residual"
  | "encoder_position"
  | "deviation"
  | "external_encoder_position"
  | "external_deviation"
  | "load_value"
  | "actual_current_scale"
  | "measured_speed"
  | "encoder_velocity"
  | "load_angle"
  | "current_scale"
  | "current_a"
  | "current_b"
  | "switch_left"
  | "switch_right"
  | "switch_reference"
  | "switch_home"
  | "position_reached"
  | "phase_a"
  | "phase_b";

const SHADES: Record<Quantity, readonly [light: string, dark: string]> = {
  position: ["#0072b2", "#56b4e9"],
  target_position: ["#8a8f98", "#8a8f98"],
  predicted_position: ["#b87400", "#e69f00"],
  velocity: ["#00795a", "#1fc497"],
  target_velocity: ["#8a8f98", "#8a8f98"],
  predicted_velocity: ["#b87400", "#e69f00"],
  acceleration: ["#a8548a", "#d98cba"],
  residual: ["#6b4fbb", "#a08bf0"],
  // an encoder and what it deviates by are one colour, the inner one's and the outer one's
  encoder_position: ["#b4408a", "#ee8fc6"],
  deviation: ["#b4408a", "#ee8fc6"],
  external_encoder_position: ["#6f6a00", "#d6cf3f"],
  external_deviation: ["#6f6a00", "#d6cf3f"],
  load_value: ["#6b4fbb", "#a08bf0"],
  actual_current_scale: ["#b87400", "#e69f00"],
  measured_speed: ["#4a7d00", "#9bd14f"],
  encoder_velocity: ["#b4408a", "#ee8fc6"],
  load_angle: ["#6b4fbb", "#a08bf0"],
  current_scale: ["#b87400", "#e69f00"],
  current_a: ["#0072b2", "#56b4e9"],
  current_b: ["#b87400", "#e69f00"],
  switch_left: ["#0072b2", "#56b4e9"],
  switch_right: ["#00795a", "#1fc497"],
  switch_reference: ["#b87400", "#e69f00"],
  switch_home: ["#b87400", "#e69f00"],
  position_reached: ["#8a8f98", "#8a8f98"],
  phase_a: ["#0072b2", "#56b4e9"],
  phase_b: ["#b87400", "#e69f00"],
};

/** Of what has no colour of its own: the same for a name on every page. */
const OTHERS: readonly Quantity[] = [
  "velocity",
  "residual",
  "predicted_position",
  "encoder_position",
  "position",
  "measured_speed",
  "acceleration",
  "external_deviation",
];

function otherOf(name: string): Quantity {
  let sum = 0;
  for (const character of name) sum = (31 * sum + (character.codePointAt(0) ?? 0)) >>> 0;
  return OTHERS[sum % OTHERS.length] ?? "velocity";
}

/** The colour of a quantity, or of any register or parameter by its name. */
export function colorOf(quantity: Quantity | (string & {}), scheme: "light" | "dark"): string {
  const known = quantity in SHADES ? (quantity as Quantity) : otherOf(quantity);
  return SHADES[known][scheme === "light" ? 0 : 1];
}
