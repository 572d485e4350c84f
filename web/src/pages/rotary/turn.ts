import { abs, floorDiv, fromNumber, plus, type Ratio, ratio, rounded, times, toNumber } from "./exact";

export type Way = "shortest" | "positive" | "negative";

/** What a turn of the driven shaft is: exact microsteps, and the position that is angle 0. */
export interface Turn {
  length: Ratio;
  zero: bigint;
}

export interface Place {
  /** whole turns, negative below zero */
  turns: bigint;
  /** within the turn, 0 <= place < length [microsteps] */
  place: Ratio;
  /** 0..360 [deg] */
  angleDeg: number;
}

export function placeOf(position: bigint, { length, zero }: Turn): Place {
  const scaled = (position - zero) * length.d;
  const turns = floorDiv(scaled, length.n);
  const place = ratio(scaled - turns * length.n, length.d);
  return { turns, place, angleDeg: toNumber(ratio(place.n * 360n * length.d, place.d * length.n)) };
}

/** A turn behind a gear: with 3 teeth on the motor and 7 on the shaft the motor turns 7/3 times a turn. */
export function geared(perMotorTurn: bigint, motorTeeth: bigint, drivenTeeth: bigint): Ratio {
  return ratio(perMotorTurn * drivenTeeth, motorTeeth);
}

/** The angle in the turn that an angle beyond it stands for, exactly: 0 <= angle < 360. */
function withinTurn(angleDeg: Ratio): Ratio {
  return plus(angleDeg, ratio(-360n * floorDiv(angleDeg.n, 360n * angleDeg.d)));
}

/**
 * Where an angle lies next to `position` that way: what the server will pick, so that the page can show the way before
 * anything moves. Of two ways of one length the shortest is the positive one; an axis that is there already stays.
 */
export function targetAt(position: bigint, turn: Turn, angleDeg: Ratio | number, way: Way): bigint {
  const angle = withinTurn(typeof angleDeg === "number" ? fromNumber(angleDeg) : angleDeg);
  const place = times(angle, ratio(turn.length.n, turn.length.d * 360n));
  const { turns } = placeOf(position, turn);
  const at = [-1n, 0n, 1n, 2n].map((more) => turn.zero + rounded(plus(times(ratio(turns + more), turn.length), place)));
  const least = (candidates: bigint[]) => candidates.reduce((a, b) => (abs(b - position) < abs(a - position) ? b : a));
  if (way === "positive") return least(at.filter((target) => target >= position));
  if (way === "negative") return least(at.filter((target) => target <= position));
  // later ones are the positive ones: they win where both ways are as long
  return at.reduce((a, b) => (abs(b - position) <= abs(a - position) ? b : a));
}

/** A way in microsteps as degrees of the shaft, signed and beyond a turn: how far the hand will go. */
export function degreesOf(way: bigint, { length }: Turn): number {
  return toNumber(ratio(way * 360n * length.d, length.n));
}

/** What the counter's change since it was known to be at `actual` adds: the shorter way round, exactly. */
export function follow(actual: bigint, counter: number, count: number, bits: number): bigint {
  const half = 2 ** (bits - 1);
  const modulus = 2 * half;
  const way = ((((count - counter + half) % modulus) + modulus) % modulus) - half;
  return actual + BigInt(Math.round(way));
}

/** Where a pointer at (x, y) from the middle is on the dial, up is 0 and right 90 [deg], 0..360. */
export function angleAt(x: number, y: number): number {
  const angle = (Math.atan2(x, -y) * 180) / Math.PI;
  return angle < 0 ? angle + 360 : angle;
}

/** `angle` on the dial's marks: whole degrees, or steps of 5 while they are asked for. */
export function snapped(angle: number, step: number): number {
  return (Math.round(angle / step) * step) % 360;
}
