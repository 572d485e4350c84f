import type { Schemas } from "../../../api/client";
import type { Axis } from "../../../api/queries";
import { rounded } from "../../../lib/format";
import { DIGITS, type MeasuredFigure } from "../../../lib/motors/changes";
import { type MotorDraft, NEW_MOTOR } from "../../../lib/motors/figures";

/**
 * A motor of one's own, as far as a study of motor and machine tells it: its coil. Null where that is not told. The inertia
 * is of rotor and load together, and the torque that of the run current: neither is the motor's.
 */
export function motorOf(
  { resistance_ohm, inductance_h }: Pick<Schemas["Identified"], "resistance_ohm" | "inductance_h">,
  axis: Pick<Axis, "full_steps_per_rev"> | undefined,
): MotorDraft | null {
  if (!resistance_ohm && !inductance_h) return null;
  return {
    ...NEW_MOTOR,
    full_steps_per_rev: axis?.full_steps_per_rev ?? NEW_MOTOR.full_steps_per_rev,
    resistance_ohm: resistance_ohm ? rounded(resistance_ohm.value, DIGITS) : null,
    inductance_h: inductance_h ? rounded(inductance_h.value, DIGITS) : null,
  };
}

/**
 * What a study of motor and machine tells for a motor of one's own that is kept already: its coil, and what is its own only
 * where nothing hangs on the shaft, or as far as what was told of it was right. `runCurrentA`: as it was told.
 */
export function measuredOf(
  found: Pick<Schemas["Identified"], "resistance_ohm" | "inductance_h" | "torque_nm" | "inertia_kgm2">,
  runCurrentA: number | null,
): MeasuredFigure[] {
  const { resistance_ohm, inductance_h, torque_nm, inertia_kgm2 } = found;
  return [
    ...(resistance_ohm ? [{ key: "resistance_ohm" as const, value: resistance_ohm.value, doubt: "" }] : []),
    ...(inductance_h ? [{ key: "inductance_h" as const, value: inductance_h.value, doubt: "" }] : []),
    ...(torque_nm && runCurrentA !== null
      ? [{ key: "holding_torque_nm" as const, value: torque_nm.value, doubt: TORQUE, withA: runCurrentA }]
      : []),
    ...(inertia_kgm2 ? [{ key: "rotor_inertia_kgm2" as const, value: inertia_kgm2.value, doubt: INERTIA }] : []),
  ];
}

const TORQUE = "by the back-EMF, and by the torque that the study was told";
const INERTIA = "of rotor and load together: the motor's where nothing hangs on its shaft";
