/**
 * Numbers without rounding. A position is 64 bits and a turn behind a gear no whole number of microsteps: a browser's
 * own numbers are exact up to 2^53 only, and after a year of rotation the angle would be what they lost.
 */
export interface Ratio {
  n: bigint;
  /** above 0, and without a common divisor with n */
  d: bigint;
}

/** A position is kept within 64 bits, sign included. */
export const MOST = (1n << 63n) - 1n;
export const LEAST = -(1n << 63n);

const MINUS = "−";
const THIN = "\u202f";
/** 10^400 typed by mistake should be refused, not computed. */
const LARGEST_EXPONENT = 40;

export const abs = (value: bigint): bigint => (value < 0n ? -value : value);

/** Division towards minus infinity. */
export function floorDiv(n: bigint, d: bigint): bigint {
  const quotient = n / d;
  return n % d !== 0n && n < 0n !== d < 0n ? quotient - 1n : quotient;
}

/** What is left of it, with the sign of the divisor. */
export function mod(n: bigint, d: bigint): bigint {
  return n - floorDiv(n, d) * d;
}

export function ratio(n: bigint, d = 1n): Ratio {
  if (d === 0n) throw new RangeError("a ratio over 0");
  let a = abs(n);
  let b = abs(d);
  while (b !== 0n) [a, b] = [b, a % b];
  const by = d < 0n ? -a : a;
  return { n: n / by, d: d / by };
}

export const times = (a: Ratio, b: Ratio): Ratio => ratio(a.n * b.n, a.d * b.d);
export const plus = (a: Ratio, b: Ratio): Ratio => ratio(a.n * b.d + b.n * a.d, a.d * b.d);

/** The nearest whole number; halves go up, as the server's do. */
export function rounded({ n, d }: Ratio): bigint {
  return floorDiv(2n * n + d, 2n * d);
}

/** As near as a browser's number comes, also where both parts are far beyond 2^53. */
export function toNumber({ n, d }: Ratio): number {
  const whole = floorDiv(n, d);
  const rest = n - whole * d;
  // the rest is below d: 60 bits of its quotient are more than a number holds
  return Number(whole) + Number((rest << 60n) / d) / 2 ** 60;
}

/** Exactly what a browser's number is: 0.1 is 3602879701896397/2^55. */
export function fromNumber(value: number): Ratio {
  if (!Number.isFinite(value)) throw new RangeError(`${value} is no ratio`);
  let scaled = value;
  let d = 1n;
  while (!Number.isInteger(scaled)) {
    scaled *= 2;
    d *= 2n;
  }
  return ratio(BigInt(scaled), d);
}

/** `1 234 567` with narrow spaces and a real minus: every digit of it. */
export function grouped(value: bigint): string {
  const digits = abs(value).toString();
  const text = digits.length > 4 ? digits.replace(/\B(?=(\d{3})+$)/g, THIN) : digits;
  return value < 0n ? MINUS + text : text;
}

/** "358 400/3", or "119 466 2/3" where `mixed`. */
export function ratioText({ n, d }: Ratio, mixed = false): string {
  if (d === 1n) return grouped(n);
  if (!mixed || abs(n) < d) return `${grouped(n)}/${grouped(d)}`;
  return `${grouped(n / d)} ${grouped(abs(n) % d)}/${grouped(d)}`;
}

/** The plain form that the server takes: "358400/3". */
export function ratioWire({ n, d }: Ratio): string {
  return d === 1n ? n.toString() : `${n}/${d}`;
}

/** A whole number out of an answer's text; null where there is none. */
export function wholeOf(text: string | null | undefined): bigint | null {
  if (text === null || text === undefined || !/^[+-]?\d+$/.test(text)) return null;
  return BigInt(text);
}

/**
 * A number as a person types it, exactly: 1 000, -3.25, 1e12, 2^40, 0x10, 1.5k, 3M, 2G, and 358400/3.
 * null where it is none.
 */
export function parseRatio(text: string): Ratio | null {
  const plain = text
    .replace(/[\s_\u202f]/g, "")
    .replace(/−/g, "-")
    .replace(",", ".");
  const parts = plain.split("/");
  if (parts.length > 2) return null;
  const [above, below] = parts.map(parseTerm);
  if (above === null || above === undefined) return null;
  if (parts.length === 1) return above;
  return below === null || below === undefined || below.n === 0n ? null : ratio(above.n * below.d, above.d * below.n);
}

const SCALES: Record<string, bigint> = { k: 1000n, M: 1_000_000n, G: 1_000_000_000n };

function parseTerm(text: string): Ratio | null {
  const hex = /^([+-]?)(0x[0-9a-f]{1,32})$/i.exec(text);
  if (hex) return ratio(hex[1] === "-" ? -BigInt(hex[2] as string) : BigInt(hex[2] as string));
  const power = /^([+-]?)(\d{1,3})\^(\d{1,3})$/.exec(text);
  if (power) {
    const [base, exponent] = [BigInt(power[2] as string), BigInt(power[3] as string)];
    if (exponent > 128n) return null;
    return ratio(power[1] === "-" ? -(base ** exponent) : base ** exponent);
  }
  const decimal = /^([+-]?)(\d*)(?:\.(\d*))?(?:e([+-]?\d{1,3}))?([kMG]?)$/.exec(text);
  if (!decimal) return null;
  const [, sign, whole = "", fraction = "", exponent = "0", scale = ""] = decimal;
  if (whole + fraction === "" || (whole + fraction).length > 60) return null;
  const shift = Number(exponent) - fraction.length;
  if (Math.abs(Number(exponent)) > LARGEST_EXPONENT) return null;
  const digits = BigInt(whole + fraction) * (SCALES[scale] ?? 1n) * (sign === "-" ? -1n : 1n);
  return shift >= 0 ? ratio(digits * 10n ** BigInt(shift)) : ratio(digits, 10n ** BigInt(-shift));
}
