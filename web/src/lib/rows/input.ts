import { rounded } from "../format";
import { type Bits, toSigned } from "./bits";

/** One physical unit of a chip quantity that is proportional to it. */
export interface Scale {
  unit: string;
  /** How much of `unit` is 1 of the chip's. */
  perChip: number;
}

export type Parsed = { ok: true; value: number } | { ok: false; why: string };

export function rangeText(bits: Pick<Bits, "minimum" | "maximum">): string {
  return bits.minimum === bits.maximum ? `only ${bits.minimum}` : `${bits.minimum} to ${bits.maximum}`;
}

const WHOLE = /^[+-]?\d+$/;
const BASED = /^0(?:x[\da-f]+|b[01]+)$/i;
const MEASURED = /^([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*([a-zµ°²/%][a-z0-9°²/^]*)$/i;

/**
 * What a person typed, as a value for the chip, or why not. Takes decimal, 0x and 0b (as the raw bits, so 0xFFFFFF
 * is -1 in a signed register of 24 bits), names of enumerated values, and numbers with one of the `scales`' units.
 */
export function parseInput(text: string, bits: Bits, scales: readonly Scale[] = []): Parsed {
  const clean = text
    .trim()
    .replace(/_/g, "")
    .replace(/\u2212/g, "-");
  const allowed = `${bits.name} takes ${rangeText(bits)}`;
  if (clean === "") return { ok: false, why: allowed };

  const named = Object.entries(bits.values).find(([, name]) => name.toLowerCase() === text.trim().toLowerCase());
  if (named) return inRange(Number(named[0]), bits);

  const based = BASED.test(clean);
  if (based || WHOLE.test(clean)) {
    const typed = Number(clean);
    if (based && typed >= 2 ** bits.width) {
      return { ok: false, why: `${clean} has more than the ${bits.width} bits of ${bits.name}` };
    }
    return inRange(based && bits.signed ? toSigned(typed, bits.width) : typed, bits);
  }

  const measured = MEASURED.exec(clean);
  if (measured) {
    const unit = plainUnit(measured[2] ?? "");
    const scale = scales.find((candidate) => plainUnit(candidate.unit) === unit);
    if (scale) return inRange(Math.round(Number(measured[1]) / scale.perChip), bits, scale);
    const known = scales.map((candidate) => candidate.unit).join(", ");
    return { ok: false, why: `${bits.name} has no unit ${measured[2]}${known ? `; it takes ${known}` : ""}` };
  }
  return { ok: false, why: `a whole number is wanted: ${rangeText(bits)}` };
}

function inRange(value: number, bits: Bits, scale?: Scale): Parsed {
  if (value >= bits.minimum && value <= bits.maximum) return { ok: true, value };
  const physical = scale
    ? ` (${short(bits.minimum * scale.perChip)} to ${short(bits.maximum * scale.perChip)} ${scale.unit})`
    : "";
  return { ok: false, why: `${bits.name} takes ${rangeText(bits)}${physical}, not ${value}` };
}

function plainUnit(unit: string): string {
  return unit
    .toLowerCase()
    .replace("°", "deg")
    .replace(/\^?2|²/g, "2");
}

function short(value: number): string {
  return String(rounded(value, 4));
}
