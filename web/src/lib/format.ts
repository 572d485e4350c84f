import { symbolOf } from "./units";

const MINUS = "−";
const THIN = "\u202f"; // narrow and unbreakable
const NOTHING = "–";

/**
 * `decimals` fixed digits after the point, thin spaces between thousands and before the unit, a real minus; a dash for
 * what is missing.
 */
export function fixed(value: number | null | undefined, decimals = 0, unit = ""): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return NOTHING;
  const rounded = Math.abs(value).toFixed(decimals);
  const [whole = "0", fraction] = rounded.split(".");
  const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, THIN) : whole;
  const negative = value < 0 && Number(rounded) !== 0;
  return `${negative ? MINUS : ""}${grouped}${fraction === undefined ? "" : `.${fraction}`}${unitBehind(unit)}`;
}

function unitBehind(unit: string): string {
  const symbol = symbolOf(unit);
  return symbol === "" || symbol === "°" ? symbol : `${THIN}${symbol}`;
}

/** Whole numbers whole, others with `digits` significant digits and no exponent where it can be avoided. */
export function compact(value: number | null | undefined, digits = 4, unit = ""): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return NOTHING;
  if (Number.isInteger(value) && Math.abs(value) < 1e9) return fixed(value, 0, unit);
  const size = Math.abs(value);
  if (size >= 1e9 || size < 1e-4) return `${value.toExponential(digits - 1).replaceAll("-", MINUS)}${unitBehind(unit)}`;
  return fixed(value, Math.max(0, digits - 1 - Math.floor(Math.log10(size))), unit);
}

/** A share as a percentage: 0.125 is 13 %. */
export function percent(share: number | null | undefined, decimals = 0): string {
  return fixed(share === null || share === undefined ? null : share * 100, decimals, "%");
}

/** The number of so many significant digits that is nearest. */
export function rounded(value: number, digits: number): number {
  return Number(value.toPrecision(digits));
}

/** A number in the path of a drawing, or in another text that no person reads. */
export function coordinate(value: number, decimals = 2): string {
  return value.toFixed(decimals);
}

/** A bound of what may be entered: whole numbers with all their digits, others with as many as anybody types. */
export function bound(value: number | undefined): string {
  if (value === undefined) return "";
  if (Number.isInteger(value) && Math.abs(value) < 1e12) return fixed(value);
  const text = compact(value, 7);
  return text.includes(".") ? text.replace(/\.?0+(?=e|$)/, "") : text;
}

/** A number with its unit: never one without the other. */
export function withUnit(value: number | null | undefined, unit: string, digits = 4): string {
  return compact(value, digits, unit);
}

/** A number of things, of which `one` is the singular: 1 turn, 2 turns. */
export function counted(count: number, one: string): string {
  return `${compact(count)} ${one}${count === 1 ? "" : "s"}`;
}

/** Seconds as people read them: 12 µs, 3.40 ms, 1.25 s, 2:05 min. */
export function duration(seconds: number | null | undefined): string {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return NOTHING;
  const size = Math.abs(seconds);
  if (size === 0) return `0${THIN}s`;
  if (size < 1e-3) return compact(seconds * 1e6, 3, "µs");
  if (size < 1) return compact(seconds * 1e3, 3, "ms");
  if (size < 60) return compact(seconds, 3, "s");
  const whole = Math.round(size);
  return `${seconds < 0 ? MINUS : ""}${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}${THIN}min`;
}

/** B, kB, MB or GB. */
export function sizeText(bytes: number | null): string {
  if (bytes === null) return NOTHING;
  if (bytes >= 1e9) return fixed(bytes / 1e9, 1, "GB");
  if (bytes >= 1e6) return fixed(bytes / 1e6, 1, "MB");
  if (bytes < 1000) return fixed(bytes, 0, "B");
  return fixed(bytes / 1e3, bytes < 1e4 ? 1 : 0, "kB");
}

/** Hz, kHz or MHz. */
export function frequency(hz: number | null | undefined): string {
  if (hz === null || hz === undefined || !Number.isFinite(hz)) return NOTHING;
  if (Math.abs(hz) >= 1e6) return compact(hz / 1e6, 4, "MHz");
  if (Math.abs(hz) >= 1e4) return compact(hz / 1e3, 4, "kHz");
  return compact(hz, 4, "Hz");
}

/** 0x0012ab34 with as many digits as `bits` need. */
export function hex(value: number, bits = 24): string {
  return `0x${(value >>> 0).toString(16).padStart(Math.ceil(bits / 4), "0")}`;
}

/** A number as a person types it: 1e3, 1.5k, 1 000, 0x10, −3. null where it is none. */
export function parseNumber(text: string): number | null {
  const plain = text.replace(/[\s_]/g, "").replaceAll(MINUS, "-").replace(",", ".");
  if (plain === "") return null;
  const scaled = /^([+-]?(?:\d+\.?\d*|\.\d+))([kM])$/.exec(plain);
  // as an exponent, not a product: 1.001 * 1000 is 1000.9999999999999
  const value = Number(scaled ? `${scaled[1]}e${scaled[2] === "k" ? 3 : 6}` : plain);
  return Number.isFinite(value) ? value : null;
}

/** As a field holds a number: all digits that count, none that are only the dust of binary sums. Never rounded. */
export function exactText(value: number, unit = ""): string {
  return `${digitsOf(value)}${unitBehind(unit)}`;
}

function digitsOf(value: number): string {
  if (Number.isSafeInteger(value)) return String(value);
  const dust = 4 * Number.EPSILON * Math.abs(value);
  for (let digits = 1; digits < 17; digits++) {
    const short = rounded(value, digits);
    if (Math.abs(short - value) <= dust) return String(short);
  }
  return String(value);
}

/** The sum of two decimal numbers as decimals add up: 0.1 and 0.2 are 0.3. */
export function decimalSum(one: number, other: number): number {
  const size = Math.floor(Math.log10(Math.max(Math.abs(one), Math.abs(other), Number.MIN_VALUE)));
  return Number((one + other).toFixed(Math.min(100, Math.max(0, 14 - size))));
}
