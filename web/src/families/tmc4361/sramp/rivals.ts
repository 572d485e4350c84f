import type { Rival } from "../../../lib/ramp/answer";

/** The corners of a trapezoid's velocity: start, end of speeding up, begin of braking, end. */
export function corners(rival: Rival, way: 1 | -1): { x: number[]; y: number[] } {
  const { vmax_pps: vmax, amax_pps2: amax, dmax_pps2: dmax, duration_s: end } = rival;
  // T = v / a + v / d + the rest at v: from the duration alone the peak of a short move follows
  const slopes = 1 / amax + 1 / dmax;
  const peak = Math.min(vmax, end / slopes);
  return { x: [0, peak / amax, end - peak / dmax, end], y: [0, way * peak, way * peak, 0] };
}
