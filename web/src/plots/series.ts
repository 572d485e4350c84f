/** What a plot draws: the x column, then one column a series, all of one length. NaN or null where nothing is. */
export type Column = ArrayLike<number | null>;
export type PlotData = readonly [x: ArrayLike<number>, ...columns: Column[]];

/**
 * A column as uPlot wants it: null where there is nothing. It draws a gap for null alone; a NaN would be connected
 * across, and spoil the scale when it comes first. A column without gaps (the usual one) is passed on uncopied.
 */
export function gapped(column: Column): Column {
  const length = column.length;
  for (let row = 0; row < length; row++) {
    const value = column[row] as number | null;
    // biome-ignore lint/suspicious/noSelfCompare: NaN alone differs from itself; Number.isNaN costs twice as much here
    if (value !== value) return withNulls(column, row);
  }
  return column;
}

function withNulls(column: Column, first: number): (number | null)[] {
  const result = new Array<number | null>(column.length);
  for (let row = 0; row < column.length; row++) {
    const value = column[row] as number | null;
    // biome-ignore lint/suspicious/noSelfCompare: see above
    result[row] = row >= first && value !== value ? null : value;
  }
  return result;
}

export function aligned(data: PlotData): PlotData {
  const [x, ...columns] = data;
  return [x, ...columns.map(gapped)];
}

/** The first row whose x is not below `x`; the length where there is none. `column` rises. */
export function lowerBound(column: ArrayLike<number>, x: number, length = column.length): number {
  let low = 0;
  let high = length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if ((column[middle] as number) < x) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The row whose x is nearest to `x`; -1 for an empty column. */
export function nearest(column: ArrayLike<number>, x: number): number {
  const row = lowerBound(column, x);
  if (row === 0) return column.length === 0 ? -1 : 0;
  if (row === column.length) return row - 1;
  return x - (column[row - 1] as number) <= (column[row] as number) - x ? row - 1 : row;
}

/**
 * `values` at other times: the value of the nearest sample, NaN further than `reach` from any. Both time columns
 * rise. This puts the samples of another device, taken at its own times, on this one's rows.
 */
export function resampled(
  times: ArrayLike<number>,
  sourceTimes: ArrayLike<number>,
  values: ArrayLike<number>,
  shift: number,
  reach: number,
): Float64Array {
  const result = new Float64Array(times.length).fill(Number.NaN);
  const last = sourceTimes.length - 1;
  if (last < 0) return result;
  let row = lowerBound(sourceTimes, (times[0] ?? 0) - shift);
  for (let index = 0; index < times.length; index++) {
    const wanted = (times[index] as number) - shift;
    while (row < last && (sourceTimes[row] as number) < wanted) row++;
    const after = Math.min(row, last);
    const before = Math.max(0, after - 1);
    const close =
      Math.abs((sourceTimes[before] as number) - wanted) < Math.abs((sourceTimes[after] as number) - wanted)
        ? before
        : after;
    if (Math.abs((sourceTimes[close] as number) - wanted) <= reach) result[index] = values[close] as number;
  }
  return result;
}
