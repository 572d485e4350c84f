import { type CoilForm, coilOf, FIRST_COIL } from "../coil";
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
    ...FIRST_COIL,
    speeds: "0.25, 0.5, 1",
    lowestKhz: 20,
    trials: 60,
  }),
  wish: (form) => ({
    study: {
      kind: "chopper",
      ...coilOf(form),
      speeds_rps: speedsOf(form.speeds),
      lowest_hz: form.lowestKhz * 1e3,
    },
    budget: { trials: form.trials, time_s: 3600 },
  }),
};
