import type { Schemas } from "../../api/client";
import { abs, parseRatio, wholeOf } from "./exact";
import { follow, type Turn } from "./turn";

export type Answer = Schemas["ExtendedPosition"];
export type Change = Schemas["ExtendedPositionChange"];
export const ROUTE = "/api/v1/devices/{device}/axes/{axis}/extended-position";
export const LATCHED_ROUTE = `${ROUTE}/latched` as const;

/** What the server says of an extended position, as numbers that lose nothing. */
export interface Extended {
  answer: Answer;
  actual: bigint | null;
  target: bigint | null;
  encoder: bigint | null;
  /** null: not rotary */
  turn: Turn | null;
  /** where the move under way began, as near as its progress tells; null without one */
  start: bigint | null;
  pieceLength: bigint;
}

export function extendedOf(answer: Answer): Extended {
  const actual = wholeOf(answer.actual_text);
  const target = wholeOf(answer.target_text);
  const length = answer.rotary ? parseRatio(answer.rotary.microsteps_per_turn) : null;
  const zero = wholeOf(answer.rotary?.zero_text) ?? 0n;
  return {
    answer,
    actual,
    target,
    encoder: wholeOf(answer.encoder_position_text),
    turn: length === null || length.n <= 0n ? null : { length, zero },
    start: startOf(actual, target, answer.progress),
    pieceLength: pieceOf(answer),
  };
}

function pieceOf(answer: Answer): bigint {
  if (answer.pieces) return BigInt(answer.pieces.length);
  return 1n << BigInt((answer.counter_bits ?? 32) - 2);
}

/** Where a move began that has come so far: what is left of it, and what share that is, say so. */
export function startOf(actual: bigint | null, target: bigint | null, progress: number | null): bigint | null {
  if (actual === null || target === null || progress === null || progress >= 1) return null;
  const left = abs(target - actual);
  const way = (left << 52n) / BigInt(Math.max(1, Math.round((1 - progress) * 2 ** 52)));
  return target > actual ? target - way : target + way;
}

/** The position at a newer count than the answer's, exactly; the answer's where there is none. */
export function liveActual(seen: Extended | null, count: number): bigint | null {
  if (seen === null || seen.actual === null) return null;
  const { counter, counter_bits: bits } = seen.answer;
  if (Number.isNaN(count) || counter === null || bits === null) return seen.actual;
  return follow(seen.actual, counter, count, bits);
}

/**
 * Where the encoder says it is at newer counts of both, exactly: as far from the commanded position as its counter is
 * from the chip's. The answer's where it is not sampled.
 */
export function liveEncoder(seen: Extended | null, count: number, encoderCount: number): bigint | null {
  const actual = liveActual(seen, count);
  // an encoder that the server does not take for one of this scale has counts, too
  if (seen === null || actual === null || seen.encoder === null) return null;
  const { counter_bits: bits } = seen.answer;
  if (Number.isNaN(count) || Number.isNaN(encoderCount) || bits === null) return seen.encoder;
  return follow(actual, count, encoderCount, bits);
}

/** What the counter shows where the compare register is to tell; null where it is not armed. */
export function compareCount({ compare, actual_text, counter }: Answer): number | null {
  const actual = wholeOf(actual_text);
  const position = wholeOf(compare?.position_text);
  if (compare === null || !compare.armed || actual === null || position === null || counter === null) return null;
  return counter + Number(position - actual);
}
