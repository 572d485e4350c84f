import type { KindForm } from "../kind";

export interface MicrostepForm {
  /** of each run [turns of the motor] */
  turns: number;
  /** [turns of the motor a second] */
  velocityRps: number;
  pairs: number;
  keep: boolean;
}

export const MICROSTEP_CALIBRATION: KindForm<MicrostepForm> = {
  label: "More exact",
  text: "A microstep table that makes up for the motor's angle error, as far as the chip's table can: by the encoder.",
  title: "Microstep calibration",
  first: () => ({ turns: 1, velocityRps: 0.05, pairs: 6, keep: false }),
  wish: ({ turns, velocityRps, pairs, keep }) => ({
    budget: { time_s: 3600 },
    study: { kind: "microstep_calibration", turns, velocity_rps: velocityRps, pairs, keep },
  }),
};
