import { useEffect, useRef } from "react";

/** Who asked the system for less motion sees pictures step that often instead of rolling [ms]. */
const STEP_MS = 100;
/** A frame that comes so much before something is due is its frame: the next would be further off [ms]. */
const HALF_FRAME_MS = 8;

/** What a frame does in which order: texts read what plots have moved. */
export type Turn = "plots" | "texts";

interface Drawer {
  draw: (nowMs: number) => void;
  periodMs: () => number;
  turn: Turn;
  dueMs: number;
  ended: boolean;
}

/** Everything on the page that draws by itself, in the order of a frame. */
let drawers: readonly Drawer[] = [];
let request = 0;
let timer: ReturnType<typeof setTimeout> | undefined;

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

/**
 * Calls `draw` in an animation frame every `periodMs()`, in each at 0, until the answer is called. The page asks for one
 * frame for all of them: what is due is drawn in it, and a page that is hidden draws nothing.
 */
export function repeatFrames(draw: (nowMs: number) => void, periodMs: () => number, turn: Turn = "plots"): () => void {
  const drawer: Drawer = { draw, periodMs, turn, dueMs: Number.NEGATIVE_INFINITY, ended: false };
  const all = [...drawers, drawer];
  drawers = [...all.filter((each) => each.turn === "plots"), ...all.filter((each) => each.turn === "texts")];
  ask();
  return () => {
    drawer.ended = true;
    drawers = drawers.filter((each) => each !== drawer);
    if (drawers.length === 0) forget();
  };
}

function forget(): void {
  clearTimeout(timer);
  cancelAnimationFrame(request);
  timer = undefined;
  request = 0;
}

function ask(): void {
  forget();
  request = requestAnimationFrame(frame);
}

function frame(nowMs: number): void {
  request = 0;
  for (const drawer of drawers) {
    if (drawer.ended || nowMs < drawer.dueMs - HALF_FRAME_MS) continue;
    const period = drawer.periodMs();
    // all of one period in the same frames: between them the page rests
    drawer.dueMs = period === 0 ? nowMs : (Math.floor((nowMs + HALF_FRAME_MS) / period) + 1) * period;
    try {
      drawer.draw(nowMs);
    } catch (error) {
      reportError(error); // as if each had a loop of its own: the others go on
    }
  }
  if (drawers.length === 0 || request !== 0) return; // what it drew has ended the last, or begun another
  const waitMs = Math.min(...drawers.map(({ dueMs }) => dueMs)) - nowMs - HALF_FRAME_MS;
  if (waitMs <= 0) ask();
  else timer = setTimeout(ask, waitMs);
}
