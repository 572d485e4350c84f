import { describe, expect, it } from "vitest";
import type { Frame } from "./frames";
import { TraceBuffer } from "./TraceBuffer";

function frame(from: number, rows: number): Frame {
  const time = Float64Array.from({ length: rows }, (_, row) => from + row);
  return { sequence: 0, rows, dropped: 0, time, columns: [time.map((t) => 10 * t), time.map((t) => -t)] };
}

describe("TraceBuffer", () => {
  it("equals a plain list cut to its capacity, for any sizes of frames", () => {
    let seed = 1;
    const random = (below: number) => {
      seed = (seed * 48_271) % 2_147_483_647;
      return seed % below;
    };
    const buffer = new TraceBuffer(["a", "b"], 50);
    let plain: number[] = [];
    let next = 0;
    for (let turn = 0; turn < 500; turn++) {
      const rows = random(turn % 20 === 0 ? 130 : 12);
      buffer.append(frame(next, rows));
      plain = [...plain, ...Array.from({ length: rows }, (_, row) => next + row)].slice(-50);
      next += rows;
      expect([...buffer.times()]).toEqual(plain);
      expect([...(buffer.column("a") ?? [])]).toEqual(plain.map((t) => 10 * t));
      expect([...(buffer.column("b") ?? [])]).toEqual(plain.map((t) => -t));
      expect(buffer.total).toBe(next);
    }
  });

  it("views, and does not copy", () => {
    const buffer = new TraceBuffer(["a", "b"], 8);
    buffer.append(frame(0, 3));
    expect(buffer.times().buffer).toBe(buffer.times().buffer);
    expect(buffer.column("a")?.length).toBe(3);
    expect(buffer.column("nothing")).toBeNull();
  });

  it("breaks the traces where something is missing, and keeps time rising", () => {
    const buffer = new TraceBuffer(["a", "b"], 8);
    buffer.gap();
    expect(buffer.length).toBe(0);
    buffer.append(frame(0, 2));
    buffer.gap();
    buffer.append(frame(5, 1));
    expect([...buffer.times()]).toEqual([0, 1, 1, 5]);
    expect([...(buffer.column("a") ?? [])]).toEqual([0, 10, Number.NaN, 50]);
  });

  it("begins anew when the device's time does", () => {
    const buffer = new TraceBuffer(["a", "b"], 8);
    buffer.append(frame(100, 4));
    buffer.append(frame(0, 2));
    expect([...buffer.times()]).toEqual([0, 1]);
  });

  it("answers for one time, and freezes", () => {
    const buffer = new TraceBuffer(["a", "b"], 8);
    expect(buffer.last("a")).toBeNaN();
    buffer.append(frame(0, 3));
    expect([-1, 0, 0.5, 2, 9].map((t) => buffer.at("a", t))).toEqual([Number.NaN, 0, 0, 20, 20]);
    const frozen = buffer.frozen();
    buffer.append(frame(3, 8));
    expect([...frozen.times()]).toEqual([0, 1, 2]);
    expect(frozen.last("b")).toBe(-2);
  });

  it("refuses a frame of other columns", () => {
    expect(() => new TraceBuffer(["a"], 8).append(frame(0, 1))).toThrow(RangeError);
  });
});
