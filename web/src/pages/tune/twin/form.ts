import type { Schemas } from "../../../api/client";
import { type MotorChoice, type NamedMotor, NO_MOTOR } from "../motor/motor";

type TwinMotor = Schemas["TwinMotor-Input"];
export type Identified = Schemas["Identified"];

/** What a twin is made of beside the axis's registers. */
export interface TwinForm extends MotorChoice {
  /** null: as soon as the motor is known */
  on: boolean | null;
  /** where its inertia and friction are from; empty: as typed */
  identified: string;
  motor: Required<Pick<TwinMotor, "holding_torque_nm" | "rated_current_a" | "load_inertia_kgm2" | "supply_v">> &
    Partial<TwinMotor>;
}

export const FIRST_TWIN: TwinForm = {
  ...NO_MOTOR,
  on: null,
  identified: "",
  motor: { holding_torque_nm: 0.45, rated_current_a: 1.5, load_inertia_kgm2: 0, supply_v: 24 },
};

/** Whether the twin is tried: where nobody said, only one whose motor is known. */
export function isTried({ on, name, identified }: TwinForm): boolean {
  return on ?? (name !== "" || identified !== "");
}

/** What the server wants of it. */
export function twinOf(form: TwinForm): Schemas["Twin-Input"] | null {
  return isTried(form) ? { motor: form.motor } : null;
}

/** With the figures of a motor of the data base; as it was where that does not tell its torque. */
export function named(form: TwinForm, motor: NamedMotor): TwinForm {
  if (motor.holding_torque_nm === null) return form;
  const coil = {
    ...(motor.resistance_ohm !== null && { resistance_ohm: motor.resistance_ohm }),
    ...(motor.inductance_h !== null && { inductance_h: motor.inductance_h }),
    ...(motor.rotor_inertia_kgm2 !== null && { rotor_inertia_kgm2: motor.rotor_inertia_kgm2 }),
  };
  const plate = { holding_torque_nm: motor.holding_torque_nm, rated_current_a: motor.rated_current_a };
  return { ...form, typed: motor.name, name: motor.name, motor: { ...form.motor, ...coil, ...plate } };
}

/**
 * With inertia, friction, damping, detent torque, coil, encoder and its play as a study of motor and machine found them,
 * `when`, and the supply as that was told; null where it could not tell the inertia. Inertia and Coulomb friction are of
 * rotor and load together: the twin's rotor has all of the former, its load all of the latter.
 */
export function asIdentified(form: TwinForm, found: Identified, when: string): TwinForm | null {
  if (found.inertia_kgm2 === null) return null;
  const friction =
    found.friction_nm === null ? {} : { load_friction_nm: Math.max(0, found.friction_nm.value), friction_nm: 0 };
  const swing = {
    ...(found.viscous_nms && { viscous_nms: Math.max(0, found.viscous_nms.value) }),
    ...(found.detent_torque_nm && { detent_torque_nm: found.detent_torque_nm.value }),
  };
  const play = found.backlash_microsteps?.value;
  const backlash = play === undefined ? {} : { backlash_deg: Math.max(0, (play * 360) / found.microsteps_per_turn) };
  const supply = found.supply_v === null ? {} : { supply_v: found.supply_v };
  const lines = found.encoder_lines === null ? {} : { counts_per_turn: 4 * found.encoder_lines };
  const coil = {
    ...(found.resistance_ohm && { resistance_ohm: found.resistance_ohm.value }),
    ...(found.inductance_h && { inductance_h: found.inductance_h.value }),
  };
  // That of the plate is with the rated current, and that of the study with the run current: as many times as told.
  const torque =
    found.torque_nm === null || found.hold_torque_nm === null
      ? {}
      : { holding_torque_nm: (form.motor.holding_torque_nm * found.torque_nm.value) / found.hold_torque_nm };
  return {
    ...form,
    identified: when,
    motor: {
      ...form.motor,
      ...torque,
      ...coil,
      ...friction,
      ...swing,
      ...backlash,
      ...supply,
      ...lines,
      rotor_inertia_kgm2: found.inertia_kgm2.value,
      load_inertia_kgm2: 0,
    },
  };
}
