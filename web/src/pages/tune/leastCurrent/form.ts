import type { KindForm } from "../kind";
import { coilFrom, type MotorChoice, type NamedMotor, NO_MOTOR } from "../motor/motor";
import { FIRST_TWIN, named, type TwinForm, twinOf } from "../twin/form";

export interface LeastCurrentForm {
  /** of a load cycle, and back [microsteps] */
  distance: number;
  /** no step may be lost at so much less current either */
  marginPercent: number;
  /** no step may be lost at so much more speed either */
  speedPercent: number;
  /** bound of the share of cycles that lose a step, at that lower current */
  lossPercent: number;
  /** of one coil [Ohm]; null: the saving is told as a share */
  resistanceOhm: number | null;
  /** RMS of one coil as it is set now [A] */
  runCurrentA: number | null;
  /** less current where the load is small, too */
  coolstep: boolean;
  /** whose figures were filled in */
  motor: MotorChoice;
  twin: TwinForm;
}

export const LEAST_CURRENT: KindForm<LeastCurrentForm> = {
  label: "Cooler",
  text: "The least run current at which a load cycle loses no step, with a margin; what that saves is told.",
  title: "Least current",
  first: (microstepsPerTurn) => ({
    distance: 2 * (microstepsPerTurn ?? 51_200),
    marginPercent: 25,
    speedPercent: 25,
    lossPercent: 5,
    resistanceOhm: null,
    runCurrentA: null,
    coolstep: true,
    motor: NO_MOTOR,
    twin: FIRST_TWIN,
  }),
  wish: (form) => ({
    study: {
      kind: "least_current",
      distance: Math.round(form.distance),
      margin: form.marginPercent / 100,
      speed_margin: form.speedPercent / 100,
      loss_rate_max: form.lossPercent / 100,
      resistance_ohm: form.resistanceOhm,
      run_current_a: form.runCurrentA,
      coolstep: form.coolstep,
      twin: twinOf(form.twin),
    },
  }),
};

/**
 * With a motor of the data base: for watts, and for a twin where its torque is known. What the current is now is not known
 * of it: the rated one is taken where it was named for this (`typed`).
 */
export function withMotor(
  { twin }: LeastCurrentForm,
  motor: NamedMotor,
  choice: MotorChoice,
  typed: boolean,
): Partial<LeastCurrentForm> {
  const { resistanceOhm } = coilFrom(motor);
  return {
    ...(resistanceOhm !== undefined && { resistanceOhm }),
    ...(typed && { runCurrentA: motor.rated_current_a }),
    motor: choice,
    twin: named(twin, motor),
  };
}
