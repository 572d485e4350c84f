import { expect, test } from "vitest";
import { figuresOfFrames } from "./linkTrial";

const frame = (took_ms: number, error: string | null = null) => ({ took_ms, error });

test("half and 99 of 100 round trips, and what was lost", () => {
  const frames = Array.from({ length: 200 }, (_, n) => frame(200 - n));
  expect(figuresOfFrames(frames)).toEqual({ sent: 200, lost: 0, medianMs: 100, p99Ms: 198 });
  expect(figuresOfFrames([...frames, frame(250, "timeout")])).toMatchObject({ sent: 201, lost: 1, p99Ms: 198 });
});

test("where nothing was answered there is no round trip", () => {
  expect(figuresOfFrames([frame(250, "timeout")])).toEqual({ sent: 1, lost: 1, medianMs: null, p99Ms: null });
  expect(figuresOfFrames([])).toEqual({ sent: 0, lost: 0, medianMs: null, p99Ms: null });
});
