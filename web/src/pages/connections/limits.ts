import { compact, parseNumber } from "../../lib/format";

/** A number that the form takes, and what holds when nothing is typed. */
export interface Limits {
  minimum: number;
  maximum: number;
  integer?: boolean;
  /** more than, not at least, `minimum` */
  above?: boolean;
  fallback: number | null;
}

/** What a field may hold, in words. */
export function limitsText(limits: Limits): string {
  const least = limits.above ? `above ${compact(limits.minimum)}` : `${compact(limits.minimum)}`;
  const range = limits.above
    ? `${least}, at most ${compact(limits.maximum)}`
    : `${least} to ${compact(limits.maximum)}`;
  return limits.integer ? `a whole number, ${range}` : range;
}

/** Why the text cannot be, or null. */
export function numberProblem(text: string, limits: Limits, required = false): string | null {
  if (text.trim() === "") return required ? `Wanted: ${limitsText(limits)}` : null;
  const value = parseNumber(text);
  if (value === null) return `Not a number. Wanted: ${limitsText(limits)}`;
  const low = limits.above ? value <= limits.minimum : value < limits.minimum;
  if (low || value > limits.maximum || (limits.integer && !Number.isInteger(value)))
    return `Wanted: ${limitsText(limits)}`;
  return null;
}

/** The number that is typed, or none. */
export function numberOf(text: string): number | undefined {
  return parseNumber(text) ?? undefined;
}

/** A number as a draft holds it. */
export function said(value: unknown): string {
  return typeof value === "number" ? String(value) : "";
}

/** Only what was said: no key at all for an empty field. */
export function only<T extends Record<string, unknown>>(record: T): Partial<T> {
  return Object.fromEntries(Object.entries(record).filter(([, value]) => value !== undefined)) as Partial<T>;
}

export type Json = Record<string, unknown>;

/** A link as it was, with what a form shows of it said anew; of another kind there is nothing to keep. */
export function over(before: Json, kind: string | undefined, shown: Json): Json {
  const kept = before.kind === kind ? before : {};
  return only({ ...kept, kind, ...shown });
}
