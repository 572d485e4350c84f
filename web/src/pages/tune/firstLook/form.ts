import type { KindForm } from "../kind";

export interface FirstLookForm {
  /** [turns of the motor] */
  turns: number;
  travelTurns: number;
}

export const FIRST_LOOK: KindForm<FirstLookForm> = {
  label: "Look at it first",
  text: "Small moves tell how encoder and switches are, and what is missing.",
  title: "First look",
  first: () => ({ turns: 1, travelTurns: 0 }),
  wish: ({ turns, travelTurns }) => ({ study: { kind: "first_look", turns, travel_turns: travelTurns } }),
};
