import type { Schemas } from "../../api/client";
import { fixed } from "../format";

export type RegisterRow = Schemas["RegisterRow"];
export type FieldRow = Schemas["FieldRow"];

/** What registers and fields share, as far as a number put into them is concerned. */
export type Bits = Pick<RegisterRow, "name" | "width" | "signed" | "minimum" | "maximum" | "values" | "unit">;

/** Bits of data in one datagram of the chips that the bit strip draws. */
export const WORD_BITS = 24;

export function toSigned(raw: number, width: number): number {
  return raw >= 2 ** (width - 1) ? raw - 2 ** width : raw;
}

export function toRaw(value: number, width: number): number {
  return value < 0 ? value + 2 ** width : value;
}

/** A field's value out of a register word. Division, not shifts: words may be wider than JavaScript's 31 bits. */
export function unpackField(word: number, field: Pick<FieldRow, "lsb" | "width" | "signed">): number {
  const raw = Math.floor(word / 2 ** field.lsb) % 2 ** field.width;
  return field.signed ? toSigned(raw, field.width) : raw;
}

/** `word` with that field replaced. */
export function packField(word: number, field: Pick<FieldRow, "lsb" | "width">, value: number): number {
  const old = (Math.floor(word / 2 ** field.lsb) % 2 ** field.width) * 2 ** field.lsb;
  return word - old + toRaw(value, field.width) * 2 ** field.lsb;
}

export function bitOf(word: number, bit: number): 0 | 1 {
  return (Math.floor(word / 2 ** bit) % 2) as 0 | 1;
}

export function readable(access: string): boolean {
  return access !== "W";
}

export function writable(access: string): boolean {
  return access !== "R";
}

/** A write acts, whatever value it brings or the chip shows: "no change" would not be "nothing to do". */
export function acts(bits: { access: string; volatile?: boolean }): boolean {
  return ["W", "RW*", "R+WC"].includes(bits.access) || bits.volatile === true;
}

const ACCESS: Record<string, string> = {
  R: "Read only. The chip ignores a write.",
  W: "Write only. The chip does not tell what it holds.",
  RW: "Read and write.",
  "RW*": "Readable. A write works, or acts, only under the condition below.",
  "R+WC": "Readable. Writing 1 clears it, writing 0 leaves it.",
  "?": "No source tells. Both are tried, and what it reads after a write is shown.",
};

export function accessText(access: string): string {
  return ACCESS[access] ?? access;
}

export interface Segment {
  /** Bit number of the highest and the lowest bit. */
  msb: number;
  lsb: number;
  /** null where the register has no meaning. */
  field: FieldRow | null;
  /** The register itself, for one without fields. */
  whole: boolean;
}

/** A field whose name holds whatever else is set. */
export function plain(field: Pick<FieldRow, "when">): boolean {
  return !field.when;
}

/** The word cut into named stretches and gaps, highest bit first, for drawing. */
export function segments(row: Pick<RegisterRow, "width" | "fields">, bits = WORD_BITS): Segment[] {
  const total = Math.max(bits, row.width);
  const gap = (msb: number, lsb: number): Segment => ({ msb, lsb, field: null, whole: false });
  if (row.fields.length === 0) {
    const whole = { msb: row.width - 1, lsb: 0, field: null, whole: true };
    return total > row.width ? [gap(total - 1, row.width), whole] : [whole];
  }
  const drawn: Segment[] = [];
  let next = total - 1;
  for (const field of [...row.fields].filter(plain).sort((a, b) => b.lsb - a.lsb)) {
    const msb = field.lsb + field.width - 1;
    // a second name of bits that have one already: the list below the strip has it
    if (msb > next) continue;
    if (msb < next) drawn.push(gap(next, msb + 1));
    drawn.push({ msb, lsb: field.lsb, field, whole: false });
    next = field.lsb - 1;
  }
  if (next >= 0) drawn.push(gap(next, 0));
  return drawn;
}

export function enumName(bits: Pick<Bits, "values">, value: number): string | undefined {
  return bits.values[String(value)];
}

/** How a value is edited: by name, as on and off, or as a number. */
export function editorOf(bits: Pick<Bits, "width" | "values" | "signed">): "select" | "check" | "number" {
  const names = Object.values(bits.values);
  if (bits.width === 1 && (names.length === 0 || (names[0] === "off" && names[1] === "on"))) return "check";
  return names.length > 1 ? "select" : "number";
}

/** A register in one line: its value, or of a packed one the fields that say something. */
export function summary(row: RegisterRow, raw: number): string {
  if (row.fields.length === 0) return fixed(row.signed ? toSigned(raw, row.width) : raw);
  const shown: string[] = [];
  let flags = 0;
  for (const field of row.fields.filter(plain)) {
    const value = unpackField(raw, field);
    const name = enumName(field, value);
    if (editorOf(field) === "check") {
      flags += 1;
      if (value === 1 && field.access !== "R") shown.push(field.name);
    } else if (field.width > 1 || value !== 0) {
      shown.push(`${field.name} ${name ?? value}`);
    }
  }
  if (shown.length > 0) return shown.join(" · ");
  return flags > 0 ? "nothing set" : "all 0";
}
