import type { Schemas } from "../../../api/client";
import type { Axis } from "../../../api/queries";
import { rounded } from "../../../lib/format";
import { type MotorDraft, NEW_MOTOR } from "../../../lib/motors/figures";

/** More than any interval of these is narrow, and as many as somebody checks against a data sheet. */
const DIGITS = 4;

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
