import { useEffect, useRef } from "react";

/** Who asked the system for less motion sees pictures step that often instead of rolling [ms]. */
const STEP_MS = 100;
/** How long after it is asked for a frame comes at the most, on a usual screen [ms]. */
const FRAME_MS = 16;

/**
 * Calls `draw` in every animation frame for as long as the component lives; ten times a second where the system asks
 * for reduced motion. `draw` may change without a restart.
 */
export function useFrame(draw: (nowMs: number) => void): void {
  const latest = useRef(draw);
  latest.current = draw;
  useEffect(() => {
    const reduced = matchMedia("(prefers-reduced-motion: reduce)");
    return repeatFrames(
      (nowMs) => latest.current(nowMs),
      () => (reduced.matches ? STEP_MS : 0),
    );
  }, []);
}

/** Calls `draw` in an animation frame every `periodMs()`, in each at 0, until the answer is called. */
export function repeatFrames(draw: (nowMs: number) => void, periodMs: () => number): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let request = 0;
  const ask = () => {
    request = requestAnimationFrame(frame);
  };
  const frame = (nowMs: number) => {
    const period = periodMs();
    if (period === 0) ask();
    else timer = setTimeout(ask, period - FRAME_MS);
    draw(nowMs);
  };
  ask();
  return () => {
    clearTimeout(timer);
    cancelAnimationFrame(request);
  };
}
