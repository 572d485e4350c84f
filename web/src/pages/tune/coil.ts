import { coilFrom, type MotorChoice, type NamedMotor, NO_MOTOR } from "./motor/motor";

/** What a chopper is calculated from. */
export interface CoilForm {
  /** whose figures were filled in */
  motor: MotorChoice;
  /** of one coil, by the motor's data sheet [Ohm] */
  resistanceOhm: number;
  /** of one coil [mH] */
  inductanceMh: number;
  /** RMS of one coil as it is set now [A] */
  runCurrentA: number;
  supplyV: number;
}

export const FIRST_COIL: CoilForm = {
  motor: NO_MOTOR,
  resistanceOhm: 2.3,
  inductanceMh: 4.4,
  runCurrentA: 1,
  supplyV: 24,
};

/** As a study's document has it. */
export function coilOf({ resistanceOhm, inductanceMh, runCurrentA, supplyV }: CoilForm) {
  return {
    resistance_ohm: resistanceOhm,
    inductance_h: inductanceMh / 1e3,
    run_current_a: runCurrentA,
    supply_v: supplyV,
  };
}

/** With what the data base knows of a motor; the run current as rated, for nothing better is known. */
export function coilWith(motor: NamedMotor, choice: MotorChoice): Partial<CoilForm> {
  return { motor: choice, ...coilFrom(motor), runCurrentA: motor.rated_current_a };
}
