import { describe, expect, it } from "vitest";
import { errorsOf, halvesOf, inputOf, kindOf, outputOf, placeOf } from "./answer";

function chip(values: Readonly<Record<string, number>>) {
  return { planned: (register: string, field?: string) => values[field ?? register] ?? null };
}

describe("a serial encoder's settings", () => {
  const ssi = chip({
    serial_enc_in_mode: 1,
    single_turn_res: 12,
    multi_turn_res: 11,
    multi_turn_in_en: 1,
    status_bit_cnt: 1,
    ssi_gray_code_en: 1,
    SER_CLK_IN_HIGH: 80,
    SER_CLK_IN_LOW: 80,
    SER_PTIME: 16000,
    ENC_IN_RES: 8192,
    SER_ENC_VARIATION: 9,
  });

  it("become a question with bits counted from 1", () => {
    expect(inputOf(ssi, 16e6, 3, 5)).toMatchObject({
      kind: "ssi",
      single_bits: 13,
      multi_bits: 12,
      status_bits: 1,
      gray: true,
      period: 16000,
      turns: 3,
      angle: 5,
      variation: 0, // it is not limited
    });
  });

  it("count as after power-on where they cannot be read", () => {
    const fresh = chip({ serial_enc_in_mode: 1, single_turn_res: 12 });
    expect(inputOf(fresh, 16e6, 0, 0)).toMatchObject({ high: 160, low: 160, repeat_wait: 240, period: 400 });
  });

  it("are none of an incremental encoder, or before they are known", () => {
    expect(kindOf(chip({ serial_enc_in_mode: 0 }))).toBeNull();
    expect(inputOf(chip({ serial_enc_in_mode: 0, single_turn_res: 12 }), 16e6, 0, 0)).toBeNull();
    expect(inputOf(chip({ serial_enc_in_mode: 3 }), 16e6, 0, 0)).toBeNull();
    expect(outputOf(chip({}), 16e6, 0, 0)).toBeNull();
  });

  it("have no turns at the output unless they are sent", () => {
    expect(outputOf(chip({ single_turn_res_out: 9, multi_turn_res_out: 3 }), 16e6, 0, 0)?.multi_bits).toBe(0);
    expect(
      outputOf(chip({ single_turn_res_out: 9, multi_turn_res_out: 3, multi_turn_out_en: 1 }), 16e6, 0, 0)?.multi_bits,
    ).toBe(4);
  });

  it("halve a clock as equally as can be", () => {
    expect(halvesOf(50e3, 16e6)).toEqual({ high: 160, low: 160 });
    expect(halvesOf(1e6, 15e6)).toEqual({ high: 7, low: 8 });
    expect(halvesOf(1e9, 16e6)).toEqual({ high: 1, low: 1 });
  });
});

describe("an answer that was heard", () => {
  const names = ["T1", "T0", "A3", "A2", "A1", "A0"];
  it("is turns and angle, Gray code or not", () => {
    expect(placeOf("110101", names, false)).toEqual({ turns: 3, angle: 5 });
    expect(placeOf("101111", names, true)).toEqual({ turns: 3, angle: 5 });
    expect(placeOf("1101", names, false)).toBeNull();
  });
});

describe("errors", () => {
  it("call bit 17 by what is compared", () => {
    const flags = { MULTI_CYCLE_FAIL_F: true, SER_ENC_VAR_F: true, SER_ENC_DATA_FAIL: false };
    expect(errorsOf(flags, true).map(({ name, set }) => [name, set])).toEqual([
      ["MULTI_CYCLE_FAIL_F", true],
      ["SER_ENC_DATA_FAIL", false],
    ]);
    expect(errorsOf(flags, false)[0]?.name).toBe("SER_ENC_VAR_F");
  });
});
