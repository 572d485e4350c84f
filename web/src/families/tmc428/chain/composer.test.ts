import { describe, expect, it } from "vitest";
import { about } from "../../../../test/catalog";
import type { FieldRow, RegisterRow } from "../../../lib/rows/bits";
import { binary, composable, datagram, frame, holds, put } from "./composer";

const FORMAT = { written: 8, tag_lsb: 17 };

function field(name: string, lsb: number, width: number, when = ""): FieldRow {
  return {
    name,
    lsb,
    width,
    when,
    signed: false,
    access: "W",
    values: {},
    minimum: 0,
    maximum: 2 ** width - 1,
  } as FieldRow;
}

function register(name: string, address: number, access: string, ...fields: FieldRow[]): RegisterRow {
  return { name, address, access, fields } as RegisterRow;
}

const CURRENT = register("SGCSCONF", 0xe, "W", field("CS", 0, 5), field("sfilt", 16, 1));

describe("a cover datagram", () => {
  it("is made of the fields of a register that is written", () => {
    expect(about("tmc2660").tagged).toEqual(FORMAT);
    const status = register("DRVSTATUS_SG", 1, "R");
    expect(composable([status, CURRENT])).toEqual([CURRENT]);
    const word = put(put(0, field("CS", 0, 5), 20), field("sfilt", 16, 1), 1);
    expect(binary(datagram(CURRENT, word, FORMAT))).toBe("11010000000000010100");
    expect(frame(datagram(CURRENT, word, FORMAT))).toBe("0d0014");
    expect(frame(datagram(register("DRVCTRL", 8, "W"), 0x3_ffff, FORMAT))).toBe("03ffff");
  });

  it("shows the fields that mean something as others are set", () => {
    const chopper = register("CHOPCONF", 0xc, "W", field("chm", 14, 1), field("hend", 7, 4, "chm = 0"));
    const others = (name: string) => (name === "SDOFF" ? 1 : null);
    expect([0, 1 << 14].map((word) => holds("chm = 0", word, chopper, others))).toEqual([true, false]);
    expect(["SDOFF = 1", "SDOFF = 0", "unheard = 1", ""].map((when) => holds(when, 0, chopper, others))).toEqual([
      true,
      false,
      true,
      true,
    ]);
  });
});
