/** What a chopper is calculated from. */
export interface CoilForm {
  /** of one coil, by the motor's data sheet [Ohm] */
  resistanceOhm: number;
  /** of one coil [mH] */
  inductanceMh: number;
  /** RMS of one coil as it is set now [A] */
  runCurrentA: number;
  supplyV: number;
}

export const FIRST_COIL: CoilForm = { resistanceOhm: 2.3, inductanceMh: 4.4, runCurrentA: 1, supplyV: 24 };

/** As a study's document has it. */
export function coilOf({ resistanceOhm, inductanceMh, runCurrentA, supplyV }: CoilForm) {
  return {
    resistance_ohm: resistanceOhm,
    inductance_h: inductanceMh / 1e3,
    run_current_a: runCurrentA,
    supply_v: supplyV,
  };
}
