import { describe, expect, it } from "vitest";
import { TelemetrySource } from "../../../live/TelemetrySource";
import { ScopeView } from "./ScopeView";

function source(): TelemetrySource {
  const made = new TelemetrySource({ device: "d", channels: ["position.0"], rateHz: 10, keepS: 10 });
  made.buffer.append({
    sequence: 0,
    rows: 2,
    dropped: 0,
    time: new Float64Array([1, 2]),
    columns: [new Float64Array([10, 20])],
  });
  return made;
}

describe("ScopeView", () => {
  it("rolls evenly though samples come in batches", () => {
    const view = new ScopeView(10, "roll");
    let previous = view.next(100, 0).window[1];
    const steps: number[] = [];
    for (let frame = 1; frame <= 120; frame++) {
      const batch = 100 + Math.floor(frame / 3) * 0.05; // 50 ms of samples every third frame
      const end = view.next(batch, (frame * 1000) / 60).window[1];
      steps.push(end - previous);
      previous = end;
    }
    for (const step of steps.slice(20)) expect(Math.abs(step - 1 / 60)).toBeLessThan(0.005);
    expect(previous).toBeCloseTo(102.2, 0);
  });

  it("waits for a move, sweeps once, and asks for the pause", () => {
    const view = new ScopeView(2, "single");
    expect(view.waiting).toBe(true);
    view.onMove(50, 50);
    expect(view.waiting).toBe(false);
    expect(view.next(50.5, 0)).toEqual({ window: [49.8, 51.8], complete: false });
    view.onMove(51, 51); // the sweep still runs
    expect(view.next(51.8, 0)).toEqual({ window: [49.8, 51.8], complete: true });
  });

  it("starts again with the next move in auto", () => {
    const view = new ScopeView(1, "auto");
    view.onMove(10, 10);
    view.onMove(10.5, 10.5);
    expect(view.next(10.9, 0).window[0]).toBeCloseTo(9.9);
    view.onMove(11, 11);
    expect(view.next(11, 0)).toMatchObject({ complete: false });
    expect(view.current()[0]).toBeCloseTo(10.9);
  });

  it("is paused at the newest sample before its first frame", () => {
    const view = new ScopeView(1, "roll");
    view.pause([source()]);
    expect(view.current()[1]).toBeCloseTo(2.02);
  });

  it("shows what was there when it was paused", () => {
    const view = new ScopeView(1, "roll");
    const live = source();
    view.next(2, 0);
    view.pause([live], [1.2, 1.4]);
    live.buffer.append({
      sequence: 1,
      rows: 1,
      dropped: 0,
      time: new Float64Array([3]),
      columns: [new Float64Array([30])],
    });
    expect([...view.bufferOf(live).times()]).toEqual([1, 2]);
    expect(view.next(3, 16).window).toEqual([1.2, 1.4]);
    view.run();
    expect(view.bufferOf(live).length).toBe(3);
  });

  it("keeps cursors on the screen while rolling and at their times when paused", () => {
    const view = new ScopeView(3, "roll");
    view.next(10, 0);
    const [from] = view.current();
    expect(view.cursors().a).toBeCloseTo(from + 1);
    view.moveCursor("a", from + 1.5);
    expect(view.cursors().a).toBeCloseTo(from + 1.5);
    view.pause([]);
    const held = view.cursors();
    view.pause([], [0, 1]);
    expect(view.cursors()).toEqual(held);
    view.fetchCursors();
    expect(view.cursors().b).toBeCloseTo(2 / 3);
  });
});
