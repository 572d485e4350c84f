import type { Schemas } from "../../../api/client";
import { type FieldRow, packField, type RegisterRow, unpackField, writable } from "../../../lib/rows/bits";

export type Behind = Schemas["DeviceInfo"]["drivers"][number];
/** Addresses of registers that are written, above the bits of a datagram, and where those bits begin. */
export type Tagged = Schemas["TaggedFormatRow"];

/** The registers of a driver that a datagram can write. */
export function composable(rows: readonly RegisterRow[]): RegisterRow[] {
  return rows.filter((row) => writable(row.access));
}

/** Fields that mean something as others are set: `when` is `name = value`, of this word or of another register. */
export function holds(when: string, word: number, row: RegisterRow, others: (field: string) => number | null): boolean {
  const [name = "", value = ""] = when.split("=").map((part) => part.trim());
  if (name === "") return true;
  const own = row.fields.find((field) => field.name === name);
  const held = own ? unpackField(word, own) : others(name);
  return held === null || held === Number(value);
}

export function put(word: number, field: FieldRow, value: number): number {
  return packField(word, field, value);
}

/** The bits that go out, the first one first: what says the register, then its word. */
export function datagram(row: RegisterRow, word: number, { written, tag_lsb }: Tagged): number {
  // an address with an upper 0 has one bit of data more
  return (row.address - written) * 2 ** tag_lsb + word;
}

export const BITS = 20;

export function binary(bits: number): string {
  return bits.toString(2).padStart(BITS, "0");
}

/** As POST .../exchange takes it. */
export function frame(bits: number): string {
  return bits.toString(16).padStart(6, "0");
}
