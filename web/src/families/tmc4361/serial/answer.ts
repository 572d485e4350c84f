import type { Schemas } from "../../../api/client";
import type { ChipRows } from "../../../lib/rows/useChipRows";

export type SerialQuestion = Schemas["SerialEncoder"];
export type SerialAnswer = Schemas["SerialEncoderResult"];
type Reader = Pick<ChipRows, "planned">;

/** GENERAL_CONF.serial_enc_in_mode. */
export const KINDS = { 1: "ssi", 3: "spi" } as const;

/** The kind of a serial encoder as it is planned; null for an incremental one, or while it is not known. */
export function kindOf(chip: Reader): "ssi" | "spi" | null {
  const mode = chip.planned("GENERAL_CONF", "serial_enc_in_mode");
  return mode === 1 || mode === 3 ? KINDS[mode] : null;
}

/** Of registers that cannot be read: what they hold until somebody writes them. */
const AFTER_POWER_ON: Readonly<Record<string, number>> = {
  SER_CLK_IN_HIGH: 160,
  SER_CLK_IN_LOW: 160,
  SSI_IN_WTIME: 240,
  SER_PTIME: 400,
};

/** What is planned for the encoder input, as a question of the calculator; null while something is not known. */
export function inputOf(chip: Reader, clockHz: number, turns: number, angle: number): SerialQuestion | null {
  const kind = kindOf(chip);
  const read = (register: string, field?: string) =>
    chip.planned(register, field) ?? AFTER_POWER_ON[field ?? register] ?? 0;
  if (kind === null || chip.planned("ENC_IN_DATA", "single_turn_res") === null) return null;
  const multi = read("ENC_IN_CONF", "multi_turn_in_en") === 1;
  const limited = read("ENC_IN_CONF", "serial_enc_variation_limit") === 1;
  return {
    kind,
    clock_hz: clockHz,
    single_bits: read("ENC_IN_DATA", "single_turn_res") + 1,
    multi_bits: multi ? read("ENC_IN_DATA", "multi_turn_res") + 1 : 0,
    status_bits: read("ENC_IN_DATA", "status_bit_cnt"),
    gray: read("ENC_IN_CONF", "ssi_gray_code_en") === 1,
    status_last: read("ENC_IN_CONF", "left_aligned_data") === 1,
    high: read("SER_CLK_IN_HIGH_LOW", "SER_CLK_IN_HIGH"),
    low: read("SER_CLK_IN_HIGH_LOW", "SER_CLK_IN_LOW"),
    delay: read("SSI_IN_CLK_DELAY___SSI_IN_WTIME", "SSI_IN_CLK_DELAY"),
    repeat_wait: read("SSI_IN_CLK_DELAY___SSI_IN_WTIME", "SSI_IN_WTIME"),
    period: read("SER_PTIME"),
    twice: read("ENC_IN_CONF", "ssi_multi_cycle_data") === 1,
    variation: limited ? read("SER_ENC_VARIATION___CL_CYCLE", "SER_ENC_VARIATION") : 0,
    counts_per_turn: read("ENC_IN_RES", "ENC_IN_RES"),
    turns,
    angle,
  };
}

/** The serial output as a question: only its bits and its angle count. */
export function outputOf(chip: Reader, clockHz: number, turns: number, angle: number): SerialQuestion | null {
  const single = chip.planned("ENC_OUT_DATA", "single_turn_res_out");
  if (single === null) return null;
  const multi = chip.planned("ENC_IN_CONF", "multi_turn_out_en") === 1;
  return {
    kind: "ssi",
    clock_hz: clockHz,
    single_bits: single + 1,
    multi_bits: multi ? (chip.planned("ENC_OUT_DATA", "multi_turn_res_out") ?? 0) + 1 : 0,
    status_bits: 0,
    gray: chip.planned("ENC_IN_CONF", "enc_out_gray") === 1,
    status_last: false,
    high: 160,
    low: 160,
    delay: 0,
    repeat_wait: 0,
    period: 0,
    twice: false,
    variation: 0,
    counts_per_turn: 0,
    turns,
    angle,
  };
}

/** Clocks of both halves for a clock of `hz`: as equal as they can be. */
export function halvesOf(hz: number, clockHz: number): { high: number; low: number } {
  const whole = Math.min(2 * 0xffff, Math.max(2, Math.round(clockHz / hz)));
  const high = Math.floor(whole / 2);
  return { high, low: whole - high };
}

/** Turns and angle of bits that were heard, by the names that the calculator gives them. Gray code is taken away. */
export function placeOf(
  heard: string,
  names: readonly string[],
  gray: boolean,
): { turns: number; angle: number } | null {
  if (heard.length < names.length) return null;
  let value = 0n;
  let last = 0n;
  let angleBits = 0;
  names.forEach((name, place) => {
    if (name.startsWith("S")) return;
    if (name.startsWith("A")) angleBits += 1;
    const bit = BigInt(heard[place] === "1");
    last = gray ? last ^ bit : bit;
    value = (value << 1n) | last;
  });
  const width = BigInt(angleBits);
  return { turns: Number(value >> width), angle: Number(value & ((1n << width) - 1n)) };
}

/** Flags of the axis that tell of a serial encoder's errors, with what they mean. */
export const ERRORS = [
  ["MULTI_CYCLE_FAIL_F", "the two answers to one request differed"],
  ["SER_ENC_VAR_F", "an answer was further away than SER_ENC_VARIATION allows; it was dropped"],
  ["SER_ENC_DATA_FAIL", "there was such an error since EVENTS was cleared"],
  ["SERIAL_ENC_FLAG[0]", "status bit 0 of the encoder is set"],
  ["SERIAL_ENC_FLAG[1]", "status bit 1 of the encoder is set"],
  ["SERIAL_ENC_FLAG[2]", "status bit 2 of the encoder is set"],
] as const;

/** The errors of a kind of encoder: one bit of STATUS has two names. */
export function errorsOf(flags: Readonly<Record<string, boolean>>, multiCycle: boolean) {
  const other = multiCycle ? "SER_ENC_VAR_F" : "MULTI_CYCLE_FAIL_F";
  return ERRORS.filter(([name]) => name !== other && name in flags).map(([name, text]) => ({
    name,
    text,
    set: flags[name] === true,
  }));
}
