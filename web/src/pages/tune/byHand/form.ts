import type { KindForm } from "../kind";

export interface ScoredMoveForm {
  /** there, and back [microsteps] */
  distance: number;
  repeats: number;
  /** a move is over when the encoder stays within it [full steps] */
  bandFullsteps: number;
}

export const SCORED_MOVE: KindForm<ScoredMoveForm> = {
  label: "By hand",
  text: "Change what you like on any page, move there or here, and compare: each move is scored, and kept with the settings in force.",
  title: "Scored move",
  first: (microstepsPerTurn) => ({ distance: microstepsPerTurn ?? 51_200, repeats: 2, bandFullsteps: 1 }),
  wish: ({ distance, repeats, bandFullsteps }) => ({
    study: { kind: "scored_move", distance: Math.round(distance), repeats, band_fullsteps: bandFullsteps },
  }),
};
