import type { Schemas } from "../../../api/client";
import { figuresText } from "../../../lib/motors/figures";

/** A motor of the data base. */
export type NamedMotor = Schemas["MotorInfo"];

/** Which motor somebody has named. */
export interface MotorChoice {
  /** what was typed to find it; null: nothing yet */
  typed: string | null;
  /** its name in the data base, whose figures were filled in; empty: none of it */
  name: string;
}

export const NO_MOTOR: MotorChoice = { typed: null, name: "" };

/** Of a run current that was filled in, and of a torque with it. */
export const RATED = "The run current is taken as rated: put in what is set where that is less";

/** Resistance and inductance of a motor, as far as they are known, as forms of a coil have them. */
export function coilFrom({ resistance_ohm, inductance_h }: NamedMotor) {
  return {
    ...(resistance_ohm !== null && { resistanceOhm: resistance_ohm }),
    ...(inductance_h !== null && { inductanceMh: inductance_h * 1e3 }),
  };
}

/** What the data base knows of a motor, in words, and where it is from. */
export function knownOf(motor: NamedMotor): string {
  return `${figuresText(motor)}: ${motor.source}`;
}
