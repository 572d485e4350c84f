import { lowerBound } from "../plots/series";
import type { TraceBuffer } from "./TraceBuffer";

/** More rows than this many a pixel are drawn as the smallest and largest of each bucket: of one pixel, then. */
export const ROWS_PER_PIXEL = 2;

/** What a plot shows of a buffer: a column, and what one of its units is worth. */
export interface Trace {
  channel: string;
  /** values are divided by it: microsteps in a millimetre, for example */
  divisor: number;
  /** added after that: which lane a switch is drawn on */
  offset?: number;
}

export interface Cut {
  x: Float64Array;
  columns: Float64Array[];
}

/**
 * The part of a buffer between two times, in the units of the traces. One row more at each end, so that lines reach
 * the edges. Where there are more rows than `mostRows`, each bucket of neighbouring rows gives two: the smallest and
 * the largest value of every trace, so that no spike is lost. Buckets are counted from the first row ever received:
 * they do not shift against the samples while the window scrolls, which would make the trace shimmer.
 */
export function cut(
  buffer: TraceBuffer,
  traces: readonly Trace[],
  from: number,
  to: number,
  mostRows = Number.POSITIVE_INFINITY,
): Cut {
  const times = buffer.times();
  const first = Math.max(0, lowerBound(times, from) - 1);
  const end = Math.min(times.length, lowerBound(times, to) + 1);
  const rows = Math.max(0, end - first);
  const size = Math.max(1, Math.ceil(rows / Math.max(2, mostRows / 2)));
  if (rows <= mostRows || size < 2) {
    return {
      x: times.slice(first, end),
      columns: traces.map((trace) => scaled(buffer.column(trace.channel), first, end, trace)),
    };
  }
  const origin = buffer.total - times.length;
  const firstBucket = Math.floor((origin + first) / size);
  const buckets = Math.floor((origin + end - 1) / size) - firstBucket + 1;
  const bounds = (bucket: number): [number, number] => {
    const start = (firstBucket + bucket) * size - origin;
    return [Math.max(first, start), Math.min(end, start + size)];
  };
  const x = new Float64Array(2 * buckets);
  for (let bucket = 0; bucket < buckets; bucket++) {
    const [start, stop] = bounds(bucket);
    x[2 * bucket] = times[start] as number;
    x[2 * bucket + 1] = times[stop - 1] as number;
  }
  return { x, columns: traces.map((trace) => extremes(buffer.column(trace.channel), buckets, bounds, trace)) };
}

function scaled(column: Float64Array | null, first: number, end: number, trace: Trace): Float64Array {
  const result = new Float64Array(Math.max(0, end - first)).fill(Number.NaN);
  if (column === null) return result;
  const factor = 1 / trace.divisor;
  const offset = trace.offset ?? 0;
  for (let row = first; row < end; row++) result[row - first] = (column[row] as number) * factor + offset;
  return result;
}

function extremes(
  column: Float64Array | null,
  buckets: number,
  bounds: (bucket: number) => [number, number],
  trace: Trace,
): Float64Array {
  const result = new Float64Array(2 * buckets).fill(Number.NaN);
  if (column === null) return result;
  const factor = 1 / trace.divisor;
  const offset = trace.offset ?? 0;
  for (let bucket = 0; bucket < buckets; bucket++) {
    const [start, stop] = bounds(bucket);
    let low = Number.POSITIVE_INFINITY;
    let high = Number.NEGATIVE_INFINITY;
    for (let row = start; row < stop; row++) {
      const value = column[row] as number;
      if (value < low) low = value;
      if (value > high) high = value;
    }
    if (low > high) continue; // nothing but gaps
    const rising = (column[start] as number) <= (column[stop - 1] as number);
    result[2 * bucket] = (rising ? low : high) * factor + offset;
    result[2 * bucket + 1] = (rising ? high : low) * factor + offset;
  }
  return result;
}
