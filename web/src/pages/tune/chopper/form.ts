import type { CoilForm } from "../CoilFields";
import type { KindForm } from "../kind";
import { speedsOf } from "../stallguard/form";

export interface ChopperForm extends CoilForm {
  /** at which the motor is to be calm [turns of the motor a second], as typed */
  speeds: string;
  /** no slower chopper is tried: it is heard [kHz] */
  lowestKhz: number;
  trials: number;
}

export const CHOPPER: KindForm<ChopperForm> = {
  label: "Calm by its chopper",
  text: "Hysteresis, TOFF and TBL of SpreadCycle by which the shaft shakes least: calculated from the motor, then tried.",
  title: "Chopper",
  first: () => ({
    resistanceOhm: 2.3,
    inductanceMh: 4.4,
    runCurrentA: 1,
    supplyV: 24,
    speeds: "0.25, 0.5, 1",
    lowestKhz: 20,
    trials: 60,
  }),
  wish: (form) => ({
    study: {
      kind: "chopper",
      resistance_ohm: form.resistanceOhm,
      inductance_h: form.inductanceMh / 1e3,
      run_current_a: form.runCurrentA,
      supply_v: form.supplyV,
      speeds_rps: speedsOf(form.speeds),
      lowest_hz: form.lowestKhz * 1e3,
    },
    budget: { trials: form.trials, time_s: 3600 },
  }),
};
