import type { KindForm } from "../kind";
import { type MotorChoice, type NamedMotor, NO_MOTOR } from "../motor/motor";

export interface IdentificationForm {
  /** whose torque was filled in */
  motor: MotorChoice;
  /** [turns of the motor a second] */
  velocityRps: number;
  hops: number;
  /** with the run current [N m]; null: unknown */
  holdTorqueNm: number | null;
  /** of the motor [V]; null: neither resistance, inductance nor back-EMF is told */
  supplyV: number | null;
  /** RMS of one coil as it is set now [A] */
  runCurrentA: number | null;
}

export const IDENTIFICATION: KindForm<IdentificationForm> = {
  label: "Know motor and machine",
  text: "Resonance, damping, friction, inertia, backlash and lines of the encoder, each with its interval: by the encoder. The setting stays.",
  title: "Motor and machine",
  first: () => ({
    motor: NO_MOTOR,
    velocityRps: 0.1,
    hops: 24,
    holdTorqueNm: null,
    supplyV: null,
    runCurrentA: null,
  }),
  wish: (form) => ({
    study: {
      kind: "identification",
      velocity_rps: form.velocityRps,
      hops: form.hops,
      hold_torque_nm: form.holdTorqueNm,
      supply_v: form.supplyV,
      run_current_a: form.runCurrentA,
    },
  }),
};

/**
 * With torque and rated current of a motor that was named for this (`typed`): they go together. What the current is now is not
 * known of it, so nothing is taken of a motor that was named elsewhere.
 */
export function withMotor(motor: NamedMotor, choice: MotorChoice, typed: boolean): Partial<IdentificationForm> {
  const torque = motor.holding_torque_nm === null ? {} : { holdTorqueNm: motor.holding_torque_nm };
  return { motor: choice, ...(typed && { ...torque, runCurrentA: motor.rated_current_a }) };
}
