import type { KindForm } from "../kind";

export interface ClosedLoopForm {
  phaseMarginDeg: number;
  gainMargin: number;
  /** [full steps] */
  stepFullsteps: number;
  keep: boolean;
}

export const CLOSED_LOOP: KindForm<ClosedLoopForm> = {
  label: "Hold by the encoder",
  text: "Gains of a position loop for asked margins: the motor's resonance is measured, the loop worked out, and shown by steps.",
  title: "Closed loop",
  first: () => ({ phaseMarginDeg: 60, gainMargin: 2, stepFullsteps: 2, keep: false }),
  wish: ({ phaseMarginDeg, gainMargin, stepFullsteps, keep }) => ({
    study: {
      kind: "closed_loop",
      phase_margin_deg: phaseMarginDeg,
      gain_margin: gainMargin,
      step_fullsteps: stepFullsteps,
      keep,
    },
  }),
};
