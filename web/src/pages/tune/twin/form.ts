import type { Schemas } from "../../../api/client";
import { type MotorChoice, type NamedMotor, NO_MOTOR } from "../motor/motor";

type TwinMotor = Schemas["TwinMotor-Input"];
type Tried = Schemas["Twin-Input"] | "as identified" | null;

/** What a twin is made of beside the axis's registers. */
export interface TwinForm extends MotorChoice {
  /** null: as soon as the motor is known, by its name or as the server has it identified */
  on: boolean | null;
  /** what was identified takes the place of these figures */
  asIdentified: boolean;
  motor: Required<Pick<TwinMotor, "holding_torque_nm" | "rated_current_a" | "load_inertia_kgm2" | "supply_v">> &
    Partial<TwinMotor>;
}

export const FIRST_TWIN: TwinForm = {
  ...NO_MOTOR,
  on: null,
  asIdentified: true,
  motor: { holding_torque_nm: 0.45, rated_current_a: 1.5, load_inertia_kgm2: 0, supply_v: 24 },
};

/** Whether the twin is tried: where nobody said, only one whose motor is known. `identified`: a study has told it */
export function isTried({ on, name }: TwinForm, identified: boolean): boolean {
  return on ?? (name !== "" || identified);
}

/** Whether all of it is left to what was identified: nothing is named or typed. */
export function byItself({ on, name, asIdentified }: TwinForm): boolean {
  return on === null && name === "" && asIdentified;
}

/** With what was identified, or with the figures as they are typed. */
export function takenFrom(form: TwinForm, asIdentified: boolean): TwinForm {
  return { ...form, asIdentified, on: asIdentified && form.name === "" ? null : true };
}

/** What the server wants of it. */
export function twinOf(form: TwinForm): Tried {
  if (form.on === false) return null;
  return byItself(form) ? "as identified" : { motor: form.motor, as_identified: form.asIdentified };
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
