import type { Progress } from "./steps";

/** The motor that was chosen, as a start-up takes it; null where none was. */
export function figuresOf({ motor }: Progress) {
  if (motor === null) return null;
  return {
    full_steps_per_rev: motor.fullStepsPerRev,
    rated_current_a: motor.ratedCurrentA,
    sense_resistor_ohm: motor.senseResistorOhm,
    current_full_scale_a: motor.fullScaleA,
  };
}
