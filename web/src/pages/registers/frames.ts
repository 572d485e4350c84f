import { hex } from "../../lib/format";
import type { RegisterRow } from "../../lib/rows/bits";

/** Bytes of one datagram of TMC428 and TMC4210. */
export const FRAME_BYTES = 4;

export type Frame = { ok: true; bytes: number[] } | { ok: false; why: string };

/** Hex as people write it: `01 00 00 00`, `0x01000000`, `01:00:00:00`. */
export function parseFrame(text: string): Frame {
  const digits = text.replace(/0x/gi, "").replace(/[\s:,]/g, "");
  if (/[^\da-f]/i.test(digits)) return { ok: false, why: "only hex digits, spaces, colons and commas" };
  if (digits.length !== 2 * FRAME_BYTES) {
    return { ok: false, why: `a datagram has ${FRAME_BYTES} bytes, 8 hex digits; here are ${digits.length} digits` };
  }
  return {
    ok: true,
    bytes: Array.from({ length: FRAME_BYTES }, (_, i) => Number.parseInt(digits.slice(2 * i, 2 * i + 2), 16)),
  };
}

export function frameText(bytes: readonly number[]): string {
  return bytes.map((byte) => byte.toString(16).padStart(2, "0")).join(" ");
}

/** RRS and six address bits, RW (1 reads), 24 data bits: TMC428 data sheet, Table 6-3. */
export function requestFrame(address: number, read: boolean, data = 0): number[] {
  return [(address << 1) | (read ? 1 : 0), (data >> 16) & 0xff, (data >> 8) & 0xff, data & 0xff];
}

export interface Request {
  address: number;
  read: boolean;
  data: number;
  row: RegisterRow | null;
}

export function decodeRequest(bytes: readonly number[], rows: readonly RegisterRow[]): Request {
  const [head = 0, high = 0, middle = 0, low = 0] = bytes;
  const address = head >> 1;
  return {
    address,
    read: (head & 1) === 1,
    data: (high << 16) | (middle << 8) | low,
    row: rows.find((row) => row.address === address) ?? null,
  };
}

/** What the request already says. */
const ECHOED = new Set(["address", "register", "axis", "rw"]);

/** What the server decoded, as lines of name and text: words in hex, set flags by their names. */
export function decodedLines(decoded: Record<string, unknown>): [name: string, text: string][] {
  return Object.entries(decoded).flatMap(([name, value]): [string, string][] => {
    if (value === null || value === undefined || ECHOED.has(name)) return [];
    if (typeof value !== "object") {
      const bits = name === "data" ? 24 : name === "status" ? 8 : null;
      return [[name, bits !== null && typeof value === "number" ? hex(value, bits) : String(value)]];
    }
    const inner = Object.entries(value);
    if (inner.length === 0) return [];
    if (inner.every(([, flag]) => typeof flag === "boolean")) {
      const set = inner.filter(([, flag]) => flag).map(([flag]) => flag);
      return [[name, set.join(" ") || "none set"]];
    }
    return [[name, inner.map(([key, item]) => `${key} ${String(item)}`).join(" · ")]];
  });
}
