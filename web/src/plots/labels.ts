import { FAMILY } from "../font";
import { fixed } from "../lib/format";
import { decimalsOf } from "./ranges";

/** What an axis is written in. Its labels are measured in it too. */
export const TEXT_PX = 12;
export const FONT = `${TEXT_PX}px ${FAMILY}`;

/** Longer plain numbers than "−2 000 000" give way to a prefix, where that is shorter. */
const PLAIN_LETTERS = 10;
const THIN = "\u202f";
const PREFIXES = ["p", "n", "µ", "m", "", "k", "M", "G", "T", "P", "E"] as const;
const PLAIN = PREFIXES.indexOf("");

function longest(texts: readonly string[]): number {
  return Math.max(0, ...texts.map((text) => text.length));
}

/** Numbers `increment` apart with one SI prefix for all: 2.5 M, 5.0 M. Nothing where null is. */
export function prefixed(values: readonly (number | null)[], increment: number): string[] {
  const most = Math.max(0, ...values.map((value) => Math.abs(value ?? 0)));
  const power = most > 0 ? Math.floor(Math.log10(most * (1 + 1e-12)) / 3) : 0;
  const index = Math.max(0, Math.min(PREFIXES.length - 1, PLAIN + power));
  const unit = 1000 ** (index - PLAIN);
  const decimals = decimalsOf(increment / unit);
  const symbol = PREFIXES[index] ? `${THIN}${PREFIXES[index]}` : "";
  return values.map((value) => (value === null ? "" : value === 0 ? "0" : `${fixed(value / unit, decimals)}${symbol}`));
}

/** Tick labels: numbers with the decimals that tell them apart; long ones with an SI prefix. */
export function tickTexts(values: readonly (number | null)[], increment: number): string[] {
  const decimals = decimalsOf(increment);
  const plain = values.map((value) => (value === null ? "" : fixed(value, decimals)));
  if (longest(plain) <= PLAIN_LETTERS) return plain;
  const short = prefixed(values, increment);
  return longest(short) < longest(plain) ? short : plain;
}

let ruler: CanvasRenderingContext2D | null = null;

/** How wide the widest of these is drawn [px]. */
export function widest(texts: readonly (string | null)[]): number {
  ruler ??= document.createElement("canvas").getContext("2d");
  if (ruler === null) return TEXT_PX * longest(texts.map((text) => text ?? ""));
  ruler.font = FONT;
  let most = 0;
  for (const text of texts) if (text) most = Math.max(most, ruler.measureText(text).width);
  return most;
}
