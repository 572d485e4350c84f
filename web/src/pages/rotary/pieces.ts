import { abs } from "./exact";

/** What is drawn of a long move: never more segments than people can tell apart. */
export const MOST_SEGMENTS = 24;

export interface Segment {
  /** counted from 0 along the way */
  index: number;
  state: "done" | "underway" | "left";
  /** how much of it is behind, 0..1 */
  share: number;
}

export interface PiecesView {
  total: number;
  done: number;
  /** the segments of the window around the one underway, in order */
  segments: Segment[];
  /** pieces before and after the window, that are not drawn each */
  before: number;
  after: number;
  /** of the whole way, 0..1 */
  progress: number;
}

/**
 * The pieces of a move from `start` to `target`, seen from `actual`. Each is `length` microsteps but the first: what
 * the way is more than whole pieces goes first, since the chip is always given the next whole piece while one is left
 * (AN-001 2.1 step 3).
 */
export function viewOf(
  start: bigint,
  target: bigint,
  actual: bigint,
  length: bigint,
  most = MOST_SEGMENTS,
): PiecesView {
  const way = abs(target - start);
  const left = clamp(abs(target - actual), 0n, way);
  const total = pieceCount(way, length);
  const leftPieces = pieceCount(left, length);
  const done = total - leftPieces;
  const first = way - BigInt(Math.max(0, total - 1)) * length;
  const size = done === 0 ? first : length;
  const aheadOfThis = BigInt(Math.max(0, leftPieces - 1)) * length;
  const share = leftPieces === 0 || size === 0n ? 0 : 1 - share01(left - aheadOfThis, size);
  const from = windowStart(total, done, most);
  const count = Math.min(total, most);
  const segments = Array.from({ length: count }, (_, position): Segment => {
    const index = from + position;
    if (index < done) return { index, state: "done", share: 1 };
    return index === done ? { index, state: "underway", share } : { index, state: "left", share: 0 };
  });
  return {
    total,
    done,
    segments,
    before: from,
    after: total - from - count,
    progress: way === 0n ? 1 : 1 - share01(left, way),
  };
}

/** How many pieces a way is. */
export function pieceCount(way: bigint, length: bigint): number {
  return Number((abs(way) + length - 1n) / length);
}

/** The window keeps the piece underway a third from its start, and never looks beyond either end. */
function windowStart(total: number, done: number, most: number): number {
  if (total <= most) return 0;
  return Math.min(total - most, Math.max(0, done - Math.floor(most / 3)));
}

function clamp(value: bigint, least: bigint, most: bigint): bigint {
  return value < least ? least : value > most ? most : value;
}

/** part/whole as a number, also where both are beyond 2^53. */
function share01(part: bigint, whole: bigint): number {
  return Number((part << 52n) / whole) / 2 ** 52;
}

/** Long times as people read them: 41 s, 3:25 min, 11 h 36 min, 12 d 4 h, 140 years. */
export function longTime(seconds: number | null): string {
  if (seconds === null || !Number.isFinite(seconds)) return "–";
  const whole = Math.round(seconds);
  if (whole < 60) return `${whole}\u202fs`;
  const [minutes, hours, days] = [Math.floor(whole / 60), Math.floor(whole / 3600), Math.floor(whole / 86_400)];
  if (minutes < 60) return `${minutes}:${String(whole % 60).padStart(2, "0")}\u202fmin`;
  if (hours < 48) return `${hours}\u202fh ${minutes % 60}\u202fmin`;
  if (days < 730) return `${days}\u202fd ${hours % 24}\u202fh`;
  return `${Math.round(days / 365.25)}\u202fyears`;
}

/** How fast an axis goes, out of where it was: calm enough to tell a time left, quick enough to follow a ramp. */
export class Pace {
  private readonly seen: { atS: number; position: bigint }[] = [];
  private readonly spanS: number;

  constructor(spanS = 3) {
    this.spanS = spanS;
  }

  add(atS: number, position: bigint): void {
    const last = this.seen.at(-1);
    if (last && atS <= last.atS) return;
    this.seen.push({ atS, position });
    while (this.seen.length > 2 && atS - (this.seen[0]?.atS ?? atS) > this.spanS) this.seen.shift();
  }

  clear(): void {
    this.seen.length = 0;
  }

  /** microsteps a second, signed; null before there are two looks */
  get pps(): number | null {
    const [first, last] = [this.seen[0], this.seen.at(-1)];
    if (!first || !last || last.atS <= first.atS) return null;
    return Number(last.position - first.position) / (last.atS - first.atS);
  }

  /** until `target` at this pace [s]; null at rest, or on the way away from it */
  timeTo(target: bigint, actual: bigint): number | null {
    const pps = this.pps;
    if (pps === null || Math.abs(pps) < 1) return target === actual ? 0 : null;
    const seconds = Number(target - actual) / pps;
    return seconds < 0 ? null : seconds;
  }
}
