import { between } from "./dial";
import { ratio, toNumber, wholeOf } from "./exact";
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

export interface Drawn extends Columns {
  /** the whole turn that the turns are counted from */
  since: bigint;
  /** the shaft turned too far between the rows for angles to say anything */
  fast: boolean;
}

interface Live {
  time: Float64Array;
  counts: Float64Array | null;
  encoderCounts: Float64Array | null;
  bits: number;
  /** where the newest row stands */
  actual: bigint | null;
  encoder: bigint | null;
  turn: Turn;
  what: "angle" | "turns";
  /** seconds of one unit of x */
  divisor: number;
}

/** Samples of a counter as what is drawn, x back from the newest. */
export function liveColumns(live: Live): Drawn {
  const { time, turn, what, divisor } = live;
  const newest = time.length === 0 ? 0 : (time[time.length - 1] as number);
  const x = Float64Array.from(time, (at) => (at - newest) / divisor);
  const since = wholeTurns(live.actual, turn);
  const column = (counts: Float64Array | null, bits: number, now: bigint | null) =>
    counts === null || now === null
      ? new Float64Array(time.length).fill(Number.NaN)
      : turnsBack(unwound(counts, bits), now, turn, since);
  const commanded = column(live.counts, live.bits, live.actual);
  const encoder = column(live.encoderCounts, 32, live.encoder);
  return drawn(x, commanded, encoder, since, what);
}

interface Looks {
  time_s: number[];
  position_text: string[];
  angle_deg: (number | null)[];
  encoder_angle_deg: (number | null)[];
}

/** Looks that the server kept as what is drawn, x back from the latest. The encoder is within half a turn of where it should be. */
export function lookColumns(looks: Looks, turn: Turn, what: "angle" | "turns", divisor: number): Drawn {
  const positions = looks.position_text.map(wholeOf);
  const newest = looks.time_s.at(-1) ?? 0;
  const x = Float64Array.from(looks.time_s, (at) => (at - newest) / divisor);
  const since = wholeTurns(positions.findLast((position) => position !== null) ?? null, turn);
  const commanded = turnsFrom(positions, turn, since);
  const encoder = Float64Array.from(looks.encoder_angle_deg, (angle, row) => {
    const told = commanded[row] as number;
    if (angle === null) return Number.NaN;
    return told + between((told - Math.floor(told)) * 360, angle) / 360;
  });
  return drawn(x, commanded, encoder, since, what);
}

function drawn(x: Float64Array, commanded: Float64Array, encoder: Float64Array, since: bigint, what: string): Drawn {
  if (what === "turns") {
    // up to a million turns a float tells microsteps apart: then they are counted from 0, as everywhere else
    const small = since > -1_000_000n && since < 1_000_000n;
    const add = small ? Number(since) : 0;
    return {
      x,
      commanded: commanded.map((t) => t + add),
      encoder: encoder.map((t) => t + add),
      since: small ? 0n : since,
      fast: false,
    };
  }
  const fast = tooFast(commanded);
  const [time, one, two] = broken(x, commanded.map(angleOf), encoder.map(angleOf)) as [
    Float64Array,
    Float64Array,
    Float64Array,
  ];
  return { x: time, commanded: one, encoder: two, since: 0n, fast };
}

const angleOf = (turns: number) => (turns - Math.floor(turns)) * 360;

function wholeTurns(position: bigint | null, turn: Turn): bigint {
  return position === null ? 0n : placeOf(position, turn).turns;
}

function turnsFrom(positions: readonly (bigint | null)[], turn: Turn, since: bigint): Float64Array {
  return Float64Array.from(positions, (position) => {
    if (position === null) return Number.NaN;
    return toNumber(ratio((position - turn.zero) * turn.length.d - since * turn.length.n, turn.length.n));
  });
}

function turnsBack(differences: Float64Array, now: bigint, turn: Turn, since: bigint): Float64Array {
  const [base] = turnsFrom([now], turn, since);
  const perTurn = toNumber(turn.length);
  return differences.map((difference) => (base as number) + difference / perTurn);
}
