import { describe, expect, it } from "vitest";
import { TraceBuffer } from "./TraceBuffer";
import { cut } from "./window";

function filled(rows: number, value: (row: number) => number): TraceBuffer {
  const buffer = new TraceBuffer(["a"], 10_000);
  const time = Float64Array.from({ length: rows }, (_, row) => row / 100);
  buffer.append({ sequence: 0, rows, dropped: 0, time, columns: [time.map((_, row) => value(row))] });
  return buffer;
}

const A = [{ channel: "a", divisor: 1 }];

describe("cut", () => {
  it("takes the rows between two times and one more at each end, in the unit asked for", () => {
    const { x, columns } = cut(
      filled(100, (row) => row),
      [{ channel: "a", divisor: 2, offset: 1 }],
      0.105,
      0.135,
    );
    expect([...x]).toEqual([0.1, 0.11, 0.12, 0.13, 0.14]);
    expect([...(columns[0] ?? [])]).toEqual([6, 6.5, 7, 7.5, 8]);
  });

  it("keeps every spike when there are too many rows", () => {
    const spiky = filled(8000, (row) => (row === 4321 ? 99 : row === 5000 ? -99 : Math.sin(row / 50)));
    const { x, columns } = cut(spiky, A, 0, 80, 400);
    expect(x.length).toBeLessThanOrEqual(404);
    expect(Math.max(...(columns[0] ?? []))).toBe(99);
    expect(Math.min(...(columns[0] ?? []))).toBe(-99);
    expect([...x]).toEqual([...x].sort((a, b) => a - b));
  });

  it("does not shift its buckets while the window scrolls", () => {
    const buffer = filled(8000, (row) => Math.sin(row * row));
    const one = cut(buffer, A, 10, 50, 400);
    const two = cut(buffer, A, 10.5, 50.5, 400);
    const shared = (x: number) => x > 12 && x < 48;
    expect([...two.x].filter(shared)).toEqual([...one.x].filter(shared));
  });

  it("leaves gaps and unknown channels empty", () => {
    const holes = filled(8000, (row) => (row >= 3000 && row < 5000 ? Number.NaN : 1));
    const { x, columns } = cut(holes, [...A, { channel: "b", divisor: 1 }], 0, 80, 400);
    const inside = [...x].findIndex((time) => time > 40);
    expect(columns[0]?.[inside]).toBeNaN();
    expect(columns[0]?.[0]).toBe(1);
    expect([...(columns[1] ?? [])].every(Number.isNaN)).toBe(true);
    expect(cut(new TraceBuffer(["a"], 4), A, 0, 1).x.length).toBe(0);
  });
});
