import { lowerBound } from "../../plots/series";

/**
 * Functions with a memory, over samples at their own times. A sample that is missing (NaN) ends what they remember: what
 * comes after a gap begins anew.
 */
type Column = Float64Array;

/** Change a second. */
export function derivative(times: Column, x: Column): Column {
  return x.map((value, row) =>
    row === 0 ? Number.NaN : (value - (x[row - 1] as number)) / ((times[row] as number) - (times[row - 1] as number)),
  );
}

/** The area below, from row `from` on: what is before only leads to it. */
export function integral(times: Column, x: Column, from: number): Column {
  let sum = 0;
  return x.map((value, row) => {
    const before = x[row - 1] as number;
    if (row <= from || Number.isNaN(before)) sum = 0;
    else sum += ((value + before) / 2) * ((times[row] as number) - (times[row - 1] as number));
    return Number.isNaN(value) ? Number.NaN : sum;
  });
}

/** The mean of the last `seconds`, or of as much of them as there is since a gap. */
export function mean(times: Column, x: Column, seconds: number): Column {
  const result = new Float64Array(x.length);
  let sum = 0;
  let first = 0;
  for (let row = 0; row < x.length; row++) {
    const value = x[row] as number;
    if (Number.isNaN(value)) {
      sum = 0;
      first = row + 1;
      result[row] = Number.NaN;
      continue;
    }
    sum += value;
    for (; (times[first] as number) <= (times[row] as number) - seconds; first++) sum -= x[first] as number;
    result[row] = sum / (row - first + 1);
  }
  return result;
}

export function rms(times: Column, x: Column, seconds: number): Column {
  const squares = x.map((value) => value * value);
  return mean(times, squares, seconds).map((square) => Math.sqrt(Math.max(0, square)));
}

/** A filter of first order; its first value is the sample's own. */
export function lowpass(times: Column, x: Column, hz: number): Column {
  let y = Number.NaN;
  return x.map((value, row) => {
    if (Number.isNaN(value) || Number.isNaN(y)) y = value;
    else {
      const elapsed = (times[row] as number) - (times[row - 1] as number);
      y += (1 - Math.exp(-2 * Math.PI * hz * elapsed)) * (value - y);
    }
    return y;
  });
}

/** The value of `seconds` before. */
export function delayed(times: Column, x: Column, seconds: number): Column {
  return times.map((time) => {
    const row = lowerBound(times, time - seconds);
    return (times[row] === time - seconds ? x[row] : x[row - 1]) ?? Number.NaN;
  });
}

/** What jumps by about a `period` goes on instead. */
export function unwrapped(x: Column, period: number): Column {
  let turns = 0;
  return x.map((value, row) => {
    const before = x[row - 1] as number;
    if (row === 0 || Number.isNaN(before)) turns = 0;
    else turns -= Math.round((value - before) / period) || 0;
    return value + turns * period;
  });
}
