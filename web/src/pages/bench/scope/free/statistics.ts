import { lowerBound } from "../../../../plots/series";
import type { Samples } from "./feed";

/** Of the samples between two times, both of them included. Values are NaN where no sample is there. */
export interface Statistics {
  samples: number;
  missing: number;
  minimum: number;
  maximum: number;
  mean: number;
  rms: number;
  /** standard deviation */
  sd: number;
  peakToPeak: number;
}

/** As the server works them out for a recording (app/calc/signals/statistics.py), from samples at rising times. */
export function statisticsOf({ times, values }: Samples, from: number, to: number): Statistics {
  let [samples, missing, sum, squares] = [0, 0, 0, 0];
  let [minimum, maximum] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  const first = lowerBound(times, from);
  for (let row = first; row < times.length && (times[row] as number) <= to; row++) {
    const value = values[row] as number;
    if (Number.isNaN(value)) {
      missing += 1;
      continue;
    }
    samples += 1;
    sum += value;
    squares += value * value;
    if (value < minimum) minimum = value;
    if (value > maximum) maximum = value;
  }
  const mean = sum / samples;
  let deviations = 0;
  for (let row = first; row < times.length && (times[row] as number) <= to; row++) {
    const value = values[row] as number;
    if (!Number.isNaN(value)) deviations += (value - mean) ** 2;
  }
  if (samples === 0) [minimum, maximum] = [Number.NaN, Number.NaN];
  return {
    samples,
    missing,
    minimum,
    maximum,
    mean,
    rms: Math.sqrt(squares / samples),
    sd: Math.sqrt(deviations / samples),
    peakToPeak: maximum - minimum,
  };
}
