import { describe, expect, it } from "vitest";
import { field, register } from "../../lib/rows/samples";
import { decodedLines, decodeRequest, frameText, parseFrame, requestFrame } from "./frames";

const DIVIDERS = register("pulse_div_ramp_div_usrs", 16, {
  fields: [
    field("usrs", 0, 3, { maximum: 6, values: { 0: "full step", 6: "64 microsteps" } }),
    field("ramp_div", 8, 4, { maximum: 13, unit: "fCLK/32/2^n" }),
    field("pulse_div", 12, 4, { maximum: 13, unit: "fCLK/32/2^n" }),
  ],
});

describe("raw datagrams", () => {
  it.each(["07 00 00 2a", "0x0700002A", "07:00:00:2a", "07,00,00,2A"])("takes %s", (text) => {
    expect(parseFrame(text)).toEqual({ ok: true, bytes: [0x07, 0, 0, 0x2a] });
  });

  it.each(["", "07 00 00", "07 00 00 2a 00", "07 00 00 2g", "seven"])("refuses %j", (text) => {
    expect(parseFrame(text).ok).toBe(false);
  });

  it("writes and reads what it says", () => {
    const frame = requestFrame(0x0c, false, 0x5706);
    expect(frameText(frame)).toBe("18 00 57 06");
    expect(decodeRequest(frame, [DIVIDERS])).toMatchObject({ address: 0x0c, read: false, data: 0x5706, row: DIVIDERS });
    expect(decodeRequest(requestFrame(0x7f, true), [DIVIDERS])).toMatchObject({ address: 0x7f, read: true, row: null });
  });

  it("shows of a reply what the request does not say already", () => {
    const decoded = {
      register: "usrs",
      axis: 0,
      data: 255,
      fields: { usrs: 6 },
      flags: { INT: true, RS1: false },
      x: {},
    };
    expect(decodedLines(decoded)).toEqual([
      ["data", "0x0000ff"],
      ["fields", "usrs 6"],
      ["flags", "INT"],
    ]);
  });
});
