import { describe, expect, it } from "vitest";
import goldenUrl from "../../../tests/telemetry/golden.bin?url&inline";
import goldenText from "../../../tests/telemetry/golden.json?raw";
import { decodeFrame, FrameError } from "./frames";

/** The frame of the layout in the comment of `decodeFrame`, written by hand. */
function build(sequence: number, dropped: bigint, columns: number[][]): ArrayBuffer {
  const rows = columns[0]?.length ?? 0;
  const message = new ArrayBuffer(24 + 8 * rows * columns.length);
  const view = new DataView(message);
  [..."SSC1"].forEach((letter, index) => {
    view.setUint8(index, letter.charCodeAt(0));
  });
  view.setUint32(4, sequence, true);
  view.setUint32(8, rows, true);
  view.setUint32(12, columns.length - 1, true);
  view.setBigUint64(16, dropped, true);
  columns.forEach((column, index) => {
    column.forEach((value, row) => {
      view.setFloat64(24 + 8 * (rows * index + row), value, true);
    });
  });
  return message;
}

/** The frame that the server's tests encode and decode too. */
function golden(): ArrayBuffer {
  const base64 = goldenUrl.slice(goldenUrl.indexOf(",") + 1);
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0)).buffer;
}

describe("decodeFrame", () => {
  it("reads the frame that both sides test", () => {
    const expected = JSON.parse(goldenText) as {
      sequence: number;
      dropped: number;
      time_s: number[];
      columns: (number | null)[][];
    };
    const frame = decodeFrame(golden());
    expect(frame.sequence).toBe(expected.sequence);
    expect(frame.dropped).toBe(expected.dropped);
    expect([...frame.time]).toEqual(expected.time_s);
    expect(frame.columns.map((column) => [...column])).toEqual(
      expected.columns.map((column) => column.map((value) => value ?? Number.NaN)),
    );
  });

  it("views time and columns in place", () => {
    const message = build(7, 12n, [
      [0.001, 0.002],
      [100, 101],
      [Number.NaN, -3.5],
    ]);
    const frame = decodeFrame(message);
    expect(frame).toMatchObject({ sequence: 7, rows: 2, dropped: 12 });
    expect([...frame.time]).toEqual([0.001, 0.002]);
    expect(frame.columns.map((column) => [...column])).toEqual([
      [100, 101],
      [Number.NaN, -3.5],
    ]);
    expect(frame.columns.every((column) => column.buffer === message)).toBe(true);
  });

  it("takes a frame without rows", () => {
    expect(decodeFrame(build(0, 0n, [[], []]))).toMatchObject({ rows: 0, columns: [new Float64Array()] });
  });

  it("refuses what is no frame", () => {
    const good = build(1, 0n, [[1], [2]]);
    expect(() => decodeFrame(new ArrayBuffer(8))).toThrow(FrameError);
    expect(() => decodeFrame(good.slice(0, good.byteLength - 8))).toThrow(/40 bytes, got 32/);
    const wrong = good.slice(0);
    new Uint8Array(wrong)[3] = 0x32;
    expect(() => decodeFrame(wrong)).toThrow(/SSC1/);
  });
});
