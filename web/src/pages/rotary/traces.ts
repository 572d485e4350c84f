import { type Ratio, ratio, toNumber } from "./exact";
import { placeOf, type Turn } from "./turn";

/** What the plots show: x, commanded, encoder. NaN where nothing is known. */
export interface Columns {
  x: Float64Array;
  commanded: Float64Array;
  encoder: Float64Array;
}

/** Two neighbours further apart than this were either side of 0 degrees, not half a turn apart. */
const WRAP_DEG = 180;

/**
 * Angles over time as lines that break where they wrap: a stroke across the whole plot is no motion. A row of nothing
 * goes between. Each column breaks by itself.
 */
export function broken(time: ArrayLike<number>, ...columns: ArrayLike<number | null>[]): Float64Array[] {
  const rows: number[][] = [[], ...columns.map(() => [])];
  for (let row = 0; row < time.length; row++) {
    const values = columns.map((column) => column[row] ?? Number.NaN);
    const before = columns.map((column) => (row === 0 ? Number.NaN : (column[row - 1] ?? Number.NaN)));
    const wraps = values.map((value, index) => Math.abs(value - (before[index] as number)) > WRAP_DEG);
    if (wraps.some(Boolean)) {
      rows[0]?.push(((time[row - 1] as number) + (time[row] as number)) / 2);
      // the columns that go on are drawn through
      wraps.forEach((wrap, index) => {
        rows[index + 1]?.push(wrap ? Number.NaN : ((values[index] as number) + (before[index] as number)) / 2);
      });
    }
    rows[0]?.push(time[row] as number);
    values.forEach((value, index) => {
      rows[index + 1]?.push(value);
    });
  }
  return rows.map((row) => Float64Array.from(row));
}

/** Whether the shaft turned so far between looks that its angle over time says nothing: half a turn or more. */
export function tooFast(turns: ArrayLike<number>): boolean {
  let fast = 0;
  for (let row = 1; row < turns.length; row++)
    if (Math.abs((turns[row] as number) - (turns[row - 1] as number)) >= 0.5) fast += 1;
  return fast > turns.length / 20;
}

/**
 * Positions as turns since a whole turn near the first: a float holds what is left exactly enough, however far away
 * the axis is. The whole turn that was taken away comes with it.
 */
export function turnsSince(positions: readonly (bigint | null)[], turn: Turn): { turns: Float64Array; since: bigint } {
  const first = positions.find((position) => position !== null) ?? turn.zero;
  const { turns: since } = placeOf(first, turn);
  const turns = Float64Array.from(positions, (position) => {
    if (position === null) return Number.NaN;
    const scaled = (position - turn.zero) * turn.length.d - since * turn.length.n;
    return toNumber(ratio(scaled, turn.length.n));
  });
  return { turns, since };
}

/**
 * A counter's samples as one line through its wraps: the difference to the newest, which is 0. A sample that is
 * missing stays so, and the counter is followed across it.
 */
export function unwound(counts: ArrayLike<number>, bits: number): Float64Array {
  const modulus = 2 ** bits;
  const result = new Float64Array(counts.length).fill(Number.NaN);
  let later = Number.NaN;
  let sum = 0;
  for (let row = counts.length - 1; row >= 0; row--) {
    const count = counts[row] as number;
    if (Number.isNaN(count)) continue;
    if (!Number.isNaN(later)) {
      const step = (((later - count) % modulus) + modulus) % modulus;
      sum -= step >= modulus / 2 ? step - modulus : step;
    }
    later = count;
    result[row] = sum;
  }
  return result;
}

/** Differences in microsteps to `angleDeg` now, as angles 0..360 of a turn of that length. */
export function anglesBack(differences: ArrayLike<number>, angleDeg: number, length: Ratio): Float64Array {
  const perTurn = toNumber(length);
  return Float64Array.from(differences, (difference) => {
    const angle = (angleDeg + (difference / perTurn) * 360) % 360;
    return angle < 0 ? angle + 360 : angle;
  });
}
