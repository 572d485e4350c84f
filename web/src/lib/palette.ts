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
  | "switch_left"
  | "switch_right"
  | "switch_reference"
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
  switch_left: ["#0072b2", "#56b4e9"],
  switch_right: ["#00795a", "#1fc497"],
  switch_reference: ["#b87400", "#e69f00"],
  position_reached: ["#8a8f98", "#8a8f98"],
  phase_a: ["#0072b2", "#56b4e9"],
  phase_b: ["#b87400", "#e69f00"],
};

export function colorOf(quantity: Quantity, scheme: "light" | "dark"): string {
  return SHADES[quantity][scheme === "light" ? 0 : 1];
}
