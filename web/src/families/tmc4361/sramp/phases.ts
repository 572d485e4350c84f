import type { Answer } from "../../../lib/ramp/answer";
import {
  COOL,
  COOL_SOFT,
  type Hues,
  PLAIN,
  type Stretch,
  stretchesIn,
  WARM,
  WARM_SOFT,
} from "../../../lib/ramp/phases";
import type { Shape } from "./design";

/** The phases of a slope up, a cruise and a slope down, in their order (DS-TMC4361 8.2 and 8.1.2). */
export const PHASES: Record<Shape, readonly string[]> = {
  s: ["B1", "B12", "B2", "B23", "B3", "B34", "B4"],
  trapezoid: ["A1L", "A1", "A2", "A3", "A3L"],
  hold: ["HOLD"],
};

/** Bows are the light shades. */
export const HUES: Hues = {
  B1: WARM_SOFT,
  B12: WARM,
  B2: ["#d6bd1a", "#e8db4a"],
  B23: PLAIN,
  B3: ["#56b4e9", "#56b4e9"],
  B34: COOL,
  B4: COOL_SOFT,
  A1L: WARM_SOFT,
  A1: WARM,
  A2: PLAIN,
  A3: COOL,
  A3L: COOL_SOFT,
};

/** Every phase of the shape in its order. */
export function stretches(phases: Answer["phases"], shape: Shape): Stretch[] {
  return stretchesIn(phases, PHASES[shape]);
}
