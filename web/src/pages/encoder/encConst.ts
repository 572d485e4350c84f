/** A fraction in lowest terms: microsteps that a count of the encoder is worth. */
export interface Fraction {
  numerator: number;
  denominator: number;
}

export interface EncConst {
  exact: Fraction;
  binary: Form;
  decimal: Form;
  /** the form with the smaller drift; null where both are as good */
  better: "binary" | "decimal" | null;
}

/** One of the two ways to write the constant: 15 bits, then a fraction of 16 bits in /65536 or in /10000. */
export interface Form {
  raw: number;
  value: number;
  /** how much further the counter runs than the motor, every turn [microsteps] */
  driftPerTurn: number;
}

const PARTS = { binary: 65_536, decimal: 10_000 } as const;

function gcd(a: number, b: number): number {
  return b === 0 ? a : gcd(b, a % b);
}

function formOf(exact: Fraction, counts: number, parts: number): Form {
  // In whole numbers: microsteps a turn times 65536 stays below 2^53.
  const scaled = Math.floor((2 * exact.numerator * parts + exact.denominator) / (2 * exact.denominator));
  const whole = Math.floor(scaled / parts);
  const raw = whole * 65_536 + (scaled - whole * parts);
  const drift = ((scaled * exact.denominator - exact.numerator * parts) * counts) / (exact.denominator * parts);
  return { raw, value: scaled / parts, driftPerTurn: drift };
}

/**
 * ENC_CONST for so many counts and microsteps a turn, both whole and above 0; null where the constant is beyond its 15
 * bits, or so small that it is 0. Source: facts on the encoder unit, section 2; DS-TMC4361 names the register only.
 */
export function encConst(counts: number, microstepsPerTurn: number): EncConst | null {
  if (!(Number.isInteger(counts) && Number.isInteger(microstepsPerTurn) && counts > 0 && microstepsPerTurn > 0))
    return null;
  const common = gcd(microstepsPerTurn, counts);
  const exact = { numerator: microstepsPerTurn / common, denominator: counts / common };
  const binary = formOf(exact, counts, PARTS.binary);
  const decimal = formOf(exact, counts, PARTS.decimal);
  if (binary.raw >= 2 ** 31 || binary.raw === 0) return null;
  const [byBinary, byDecimal] = [Math.abs(binary.driftPerTurn), Math.abs(decimal.driftPerTurn)];
  return {
    exact,
    binary,
    decimal,
    better: byBinary === byDecimal ? null : byBinary < byDecimal ? "binary" : "decimal",
  };
}

/** What a word of ENC_CONST stands for, read with a fraction of that kind; below 0 it counts the other way. */
export function encConstValue(raw: number, decimal: boolean): number {
  const whole = Math.floor(raw / 65_536);
  return whole + (raw - whole * 65_536) / (decimal ? PARTS.decimal : PARTS.binary);
}

/**
 * The word for a constant that counts the other way, as a number with sign: binary as a two's complement, decimal with
 * a negative whole part and what is added to it to come to the fraction (facts on the TMC5xxx, section 8).
 */
export function negativeWord(raw: number, decimal: boolean): number {
  if (!decimal) return -raw;
  const [whole, fraction] = [Math.floor(raw / 65_536), raw % 65_536];
  return fraction === 0 ? -whole * 65_536 : -(whole + 1) * 65_536 + (PARTS.decimal - fraction);
}

/** How many counts a turn has by the constant in the chip, to the nearest whole one, whichever way; null where it holds none. */
export function countsOf(raw: number, decimal: boolean, microstepsPerTurn: number): number | null {
  const value = encConstValue(raw, decimal);
  const counts = value === 0 ? 0 : Math.round(microstepsPerTurn / Math.abs(value));
  return counts > 0 ? counts : null;
}

export function fractionText({ numerator, denominator }: Fraction): string {
  return denominator === 1 ? String(numerator) : `${numerator}/${denominator}`;
}
