import type { Schemas } from "../../../api/client";

export type HoldDelay = Schemas["HoldDelay"];

/** When what happens after the last step [s]: standstill is seen, the current begins to fall, and is down. */
export function holdTimes(delay: HoldDelay): { seenS: number; fallsS: number; downS: number } {
  const falls = delay.standstill_s + (delay.waiting_s ?? 0);
  return { seenS: delay.standstill_s, fallsS: falls, downS: falls + delay.lowering_s };
}

/**
 * The current over time around a stop at time 0, as a line of steps: the motor runs, takes its last step, waits, and
 * goes from the run scale to the hold scale by one a step. `ampsOf` is what a scale is in A.
 */
export function holdLine(
  delay: HoldDelay,
  irun: number,
  ihold: number,
  ampsOf: (scale: number) => number,
): { x: number[]; y: number[] } {
  const { fallsS, downS } = holdTimes(delay);
  const lead = Math.max(0.05, downS * 0.18);
  const x = [-lead, fallsS];
  const y = [ampsOf(irun), ampsOf(irun)];
  const way = Math.sign(ihold - irun);
  for (let scale = irun; scale !== ihold; ) {
    scale += way;
    const at = fallsS + Math.abs(scale - irun) * delay.step_s;
    x.push(at, at);
    y.push(ampsOf(scale - way), ampsOf(scale));
  }
  x.push(Math.max(downS, fallsS) + lead);
  y.push(ampsOf(ihold));
  return { x, y };
}
