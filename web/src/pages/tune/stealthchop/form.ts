import { type CoilForm, coilOf, FIRST_COIL } from "../coil";
import type { KindForm } from "../kind";
import type { NamedMotor } from "../motor/motor";

export interface StealthChopForm extends CoilForm {
  /** both coils at the rated current [N m]; null: the chip alone tunes what velocity adds */
  holdingTorqueNm: number | null;
  /** RMS of one coil at that torque [A] */
  ratedCurrentA: number | null;
  /** runs go through all speeds up to it [turns of the motor a second] */
  velocityMaxRps: number;
  /** so far the shaft may swing as the choppers change [full steps] */
  joltMax: number;
}

export const STEALTHCHOP: KindForm<StealthChopForm> = {
  label: "Silent by StealthChop",
  text: "PWM_OFS and PWM_GRAD that fit the motor, and how fast StealthChop may go before the change to SpreadCycle jolts.",
  title: "StealthChop",
  first: () => ({
    ...FIRST_COIL,
    holdingTorqueNm: null,
    ratedCurrentA: null,
    velocityMaxRps: 3,
    joltMax: 0.5,
  }),
  wish: (form) => ({
    study: {
      kind: "stealthchop",
      ...coilOf(form),
      holding_torque_nm: form.holdingTorqueNm,
      rated_current_a: form.ratedCurrentA,
      velocity_max_rps: form.velocityMaxRps,
      jolt_max_fullsteps: form.joltMax,
    },
    budget: { time_s: 1800 },
  }),
};

/** Torque and rated current of a motor; nothing where its torque is not known, for one goes with the other. */
export function torqueFrom(motor: NamedMotor): Partial<StealthChopForm> {
  if (motor.holding_torque_nm === null) return {};
  return { holdingTorqueNm: motor.holding_torque_nm, ratedCurrentA: motor.rated_current_a };
}
