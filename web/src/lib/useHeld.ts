import { useEffect, useState } from "react";

/** So long an answer may be on its way before what the server says counts again. */
const ANSWER_WITHIN_MS = 1500;

/**
 * A value of the server that is being changed by hand: what the hand has set is shown, and goes on from there, until the
 * server's answer to it is here. A key pressed meanwhile would else begin from the value of before, and be lost.
 */
export function useHeld(value: number): [shown: number, hold: (next: number) => void] {
  const [held, hold] = useState<number | null>(null);
  useEffect(() => {
    if (held === null) return;
    if (Math.abs(held - value) <= 1e-9 * Math.max(1, Math.abs(held))) {
      hold(null);
      return;
    }
    const timer = window.setTimeout(() => hold(null), ANSWER_WITHIN_MS);
    return () => window.clearTimeout(timer);
  }, [held, value]);
  return [held ?? value, hold];
}
