import type { Leg } from "../module/HeldRun";

/** The fraction that numbers of samples a period are given: its multiples spread most evenly. */
const GOLDEN = 0.618034;
/** Fewer samples a period than this, and the speed would have to change too much. */
const FEWEST = 8;

/**
 * The speed near `wanted` at which samples of that rate do not fall on the same places of every period: 40 samples to
 * a period would look at 40 places alone, however long it turns.
 */
export function spreadingSpeed(wanted: number, period: number, rateHz: number): number {
  const samples = (period * rateHz) / Math.abs(wanted);
  if (!(samples >= FEWEST)) return wanted;
  return (Math.sign(wanted) * period * rateHz) / (Math.floor(samples) + GOLDEN);
}

export interface Turns {
  rpm: number;
  turns: number;
  /** and the same way back */
  back: boolean;
}

/** Full steps of an electrical period. */
const PERIOD_FULLSTEPS = 4;

/** Whole turns there, and back if wanted; a little more than whole, so that the start of the ramp is seen twice. */
export function turnLegs(
  { rpm, turns, back }: Turns,
  microstepsPerTurn: number,
  rateHz: number,
  fullStepsPerTurn = 200,
): Leg[] {
  const period = (microstepsPerTurn / fullStepsPerTurn) * PERIOD_FULLSTEPS;
  const velocityPps = spreadingSpeed((rpm / 60) * microstepsPerTurn, period, rateHz);
  const forS = ((turns + 0.05) * microstepsPerTurn) / velocityPps;
  return back
    ? [
        { velocityPps, forS },
        { velocityPps: -velocityPps, forS },
      ]
    : [{ velocityPps, forS }];
}
