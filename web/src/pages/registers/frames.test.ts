import { describe, expect, it } from "vitest";
import { deviceOf } from "../../../test/catalog";
import { field, register } from "../../lib/rows/samples";
import { crc8, decodedLines, decodeRequest, frameText, parseFrame, wireOf } from "./frames";

const wire = (model: string, link: object = { kind: "emulator" }) => wireOf(deviceOf(model, { link }));
const SPI32 = wire("tmc428");

const DIVIDERS = register("pulse_div_ramp_div_usrs", 16, {
  fields: [
    field("usrs", 0, 3, { maximum: 6, values: { 0: "full step", 6: "64 microsteps" } }),
    field("ramp_div", 8, 4, { maximum: 13, unit: "fCLK/32/2^n" }),
    field("pulse_div", 12, 4, { maximum: 13, unit: "fCLK/32/2^n" }),
  ],
});

describe("datagrams that a table tells", () => {
  const told = (spi: object) =>
    wireOf({ about: { ...deviceOf("tmc428").about, spi: spi as never }, link: { kind: "emulator" } as never });

  it("puts write bit, address and data where the table has them", () => {
    const wire = told({
      data_bits: 16,
      address_bits: 10,
      write_bit: "high",
      write_is: 1,
      byte_order: "little",
      answer: "next",
    });
    const frame = wire.frame(0x385, false, 0x1234);
    expect(frameText(frame)).toBe("83 85 34 12");
    expect(wire.asked(frame)).toEqual({ address: 0x385, read: false, data: 0x1234 });
    expect(wire.sizes).toEqual([4, 4]);
  });

  it("says what a known chip says", () => {
    const same = told({
      data_bits: 24,
      address_bits: 7,
      write_bit: "low",
      write_is: 0,
      byte_order: "big",
      answer: "same",
    });
    for (const [address, read, data] of [
      [0x0c, false, 0x5706],
      [0x7f, true, 0],
    ] as const)
      expect(same.frame(address, read, data)).toEqual(SPI32.frame(address, read, data));
  });

  it("holds more than 32 bits", () => {
    const wire = told({
      data_bits: 64,
      address_bits: 7,
      write_bit: "high",
      write_is: 0,
      byte_order: "big",
      answer: "same",
    });
    const frame = wire.frame(1, true, 2 ** 53 - 1);
    expect(frameText(frame)).toBe("81 00 1f ff ff ff ff ff ff");
    expect(wire.asked(frame)).toEqual({ address: 1, read: true, data: 2 ** 53 - 1 });
  });

  it("says registers by the uppermost of 20 bits", () => {
    const about = { ...deviceOf("tmc428").about, tagged: { written: 8, tag_lsb: 17 } };
    const wire = wireOf({ about, link: { kind: "emulator" } as never });
    expect(frameText(wire.frame(0xf, false, 0xf040))).toBe("0e f0 40");
    expect(wire.asked([0x0e, 0xf0, 0x40])).toEqual({ address: 0xf, read: false, data: 0xf040 });
    expect(wire.asked(wire.frame(8, false, 0x20005))).toEqual({ address: 8, read: false, data: 0x20005 });
  });
});

describe("raw datagrams", () => {
  it.each(["07 00 00 2a", "0x0700002A", "07:00:00:2a", "07,00,00,2A"])("takes %s", (text) => {
    expect(parseFrame(text, SPI32)).toEqual({ ok: true, bytes: [0x07, 0, 0, 0x2a] });
  });

  it.each(["", "07 00 00", "07 00 00 2a 00", "07 00 00 2g", "seven"])("refuses %j", (text) => {
    expect(parseFrame(text, SPI32).ok).toBe(false);
  });

  it("writes and reads what it says", () => {
    const frame = SPI32.frame(0x0c, false, 0x5706);
    expect(frameText(frame)).toBe("18 00 57 06");
    expect(decodeRequest(frame, SPI32, [DIVIDERS])).toMatchObject({
      address: 0x0c,
      read: false,
      data: 0x5706,
      row: DIVIDERS,
    });
    const read = SPI32.frame(0x7f, true, 0);
    expect(decodeRequest(read, SPI32, [DIVIDERS])).toMatchObject({ address: 0x7f, read: true, row: null });
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
    expect(decodedLines(decoded, 24)).toEqual([
      ["data", "0x0000ff"],
      ["fields", "usrs 6"],
      ["flags", "INT"],
    ]);
  });
});

describe("the wires of chips with 32 data bits", () => {
  it("say a write with the highest bit, and know what is read from what is written at one address", () => {
    const spi = wire("tmc5160");
    expect(frameText(spi.frame(0x27, false, 200_000))).toBe("a7 00 03 0d 40");
    const ioin = register("IOIN", 32, { address: 4, access: "R" });
    const output = register("OUTPUT", 1, { address: 4, access: "W" });
    expect(decodeRequest(spi.frame(4, true, 0), spi, [ioin, output])?.row?.name).toBe("IOIN");
    expect(decodeRequest(spi.frame(4, false, 1), spi, [ioin, output])).toMatchObject({ data: 1, row: output });
    expect(decodeRequest(spi.frame(0x21, false, 0xffff_fe0c), spi, [])?.data).toBe(0xffff_fe0c);
    expect(parseFrame("21 00 00 00", wire("tmc4361")).ok).toBe(false);
  });

  it("close a UART's datagram with a CRC, as published", () => {
    // facts: tmc5xxx-ramp, 7
    expect(crc8([5, 0, 0])).toBe(0x48);
    expect(crc8([5, 0xff, 0x21, 0xff, 0xff, 0xfe, 0x0c])).toBe(0x97);
    const node = wire("tmc5130", { kind: "uart", node: 1 });
    expect(frameText(node.frame(0x21, true, 0))).toBe("05 01 21 6b");
    expect(frameText(wire("tmc5160", { kind: "uart" }).frame(0x27, false, 200_000))).toBe("05 00 a7 00 03 0d 40 31");
    expect(frameText(wire("tmc5062", { kind: "uart" }).frame(0x24, false, 10_000))).toBe("05 a4 00 00 27 10 71");
    expect(parseFrame("05 01 21 6a", node)).toEqual({ ok: false, why: expect.stringContaining("0x6b") });
    expect(decodeRequest([5, 1, 0x21, 0x6b], node, [])).toMatchObject({ address: 0x21, read: true });
  });

  it("are commands through an evaluation board", () => {
    const board = wire("tmc4361", { kind: "landungsbruecke", motor: 0 });
    expect(frameText(board.frame(0x24, false, 0x100))).toBe("01 92 24 00 00 00 01 00 b8");
    expect(decodeRequest(board.frame(0x24, true, 0), board, [])).toMatchObject({ address: 0x24, read: true });
    expect(board.asked([1, 136, 1, 0, 0, 0, 0, 0, 138])).toBeNull();
    expect(parseFrame("01 92 24 00 00 00 01 00 b9", board).ok).toBe(false);
  });
});
