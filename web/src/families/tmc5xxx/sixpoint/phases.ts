import type { Answer } from "../../../lib/ramp/answer";
import type { Mode } from "../../../lib/ramp/DesignPlots";
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

/** The phases by the register that shapes each; the calculator spells them out. */
const SHORT: Record<string, string> = {
  "acceleration A1": "A1",
  "acceleration AMAX": "AMAX",
  "constant velocity": "VMAX",
  "deceleration DMAX": "DMAX",
  "deceleration AMAX": "AMAX",
  "deceleration D1": "D1",
  wait: "TZEROWAIT",
};

const ORDER: Record<Mode, readonly string[]> = {
  position: ["A1", "AMAX", "VMAX", "DMAX", "D1"],
  velocity: ["AMAX", "VMAX"],
};

export const HUES: Hues = { A1: WARM_SOFT, AMAX: WARM, VMAX: PLAIN, DMAX: COOL, D1: COOL_SOFT, TZEROWAIT: PLAIN };

/** Every phase of the ramp in its order. */
export function stretches(phases: Answer["phases"], mode: Mode): Stretch[] {
  return stretchesIn(
    phases.map((phase) => ({ ...phase, name: SHORT[phase.name] ?? phase.name })),
    ORDER[mode],
  );
}
