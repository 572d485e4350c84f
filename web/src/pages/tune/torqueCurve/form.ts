import type { KindForm } from "../kind";
import { type MotorChoice, NO_MOTOR } from "../motor/motor";
import { firstSeenBy, type SeenBy } from "../seenBy";

export interface TorqueForm {
  /** the inertia of whose rotor was filled in */
  motor: MotorChoice;
  seenBy: SeenBy;
  /** never faster [turns of the motor a second] */
  velocityMaxRps: number;
  /** room from where it stands, to positions above [turns of the motor] */
  travelTurns: number;
  speeds: number;
  repeats: number;
  /** of rotor and load [kg m²]; null: accelerations alone are told */
  inertiaKgm2: number | null;
  /** how well it is known */
  inertiaPercent: number;
  /** of the axis, added to the torque [N m] */
  frictionNm: number;
}

export const TORQUE_CURVE: KindForm<TorqueForm> = {
  label: "Torque known",
  text: "How much torque the motor has at each speed, and what its ramp leaves of it: accelerated until steps are lost.",
  title: "Torque over speed",
  first: (_, sees) => ({
    motor: NO_MOTOR,
    seenBy: firstSeenBy(sees),
    velocityMaxRps: 20,
    travelTurns: 60,
    speeds: 8,
    repeats: 4,
    inertiaKgm2: null,
    inertiaPercent: 5,
    frictionNm: 0,
  }),
  wish: (form) => ({
    study: {
      kind: "torque_curve",
      seen_by: form.seenBy,
      velocity_max_rps: form.velocityMaxRps,
      travel_turns: form.travelTurns,
      speeds: form.speeds,
      repeats: form.repeats,
      inertia_kgm2: form.inertiaKgm2,
      inertia_share: form.inertiaPercent / 100,
      friction_nm: form.frictionNm,
    },
  }),
};
