/** The TMC428's microstep table: a quarter wave of 64 values of 0..63 (data sheet, chapter 12). */
export const ENTRIES = 64;
export const TOP = 63;

export type Method = "half_rounded_64" | "63" | "offset";

export interface Formula {
  sigma: number;
  offset: number;
  amplitude: number;
  method: Method;
  /** stretch a shape that does not reach 1 (the box) until it does */
  full_scale: boolean;
}

/** A table by formula, or one drawn, pasted or read as numbers. */
export type Draft = { kind: "formula"; formula: Formula } | { kind: "values"; values: number[]; origin: Origin };
export type Origin = "hand" | "chip" | "pasted";

export const SINE: Formula = { sigma: 0, offset: 0, amplitude: 63, method: "half_rounded_64", full_scale: false };

export interface Preset {
  name: string;
  formula: Formula;
}

export const PRESETS: readonly Preset[] = [
  { name: "Sine, rounded (data sheet 1)", formula: SINE },
  { name: "Sine, 63 (data sheet 2)", formula: { ...SINE, method: "63" } },
  { name: "Sine with offset 8, for mixed decay", formula: { ...SINE, method: "offset", offset: 8 } },
  { name: "Towards box, σ +0.25", formula: { ...SINE, sigma: 0.25 } },
  { name: "Towards box, σ +0.5", formula: { ...SINE, sigma: 0.5 } },
  { name: "Towards rhomb, σ −0.25", formula: { ...SINE, sigma: -0.25 } },
  { name: "Towards rhomb, σ −0.5", formula: { ...SINE, sigma: -0.5 } },
  { name: "Box, σ +1", formula: { ...SINE, sigma: 1 } },
  { name: "Rhomb, σ −1", formula: { ...SINE, sigma: -1 } },
];

export function clamp(value: number): number {
  return Math.min(TOP, Math.max(0, Math.round(value)));
}

/** With one entry changed. */
export function withEntry(values: readonly number[], index: number, value: number): number[] {
  return values.map((old, at) => (at === index ? clamp(value) : old));
}

/** With a stroke of the pen: every entry that the line from one point to the other passes, as a table holds it. */
export function withStroke(
  values: readonly number[],
  from: { index: number; value: number },
  to: { index: number; value: number },
  held = clamp,
): number[] {
  const [left, right] = from.index <= to.index ? [from, to] : [to, from];
  const span = right.index - left.index;
  return values.map((old, at) => {
    if (at < left.index || at > right.index) return old;
    if (span === 0) return held(to.value);
    return held(left.value + ((right.value - left.value) * (at - left.index)) / span);
  });
}

/** The 32 datagrams that write a table: entries 2w and 2w+1 to RAM word w (data sheet, Table 12-2). */
export function datagrams(values: readonly number[]): number[] {
  return Array.from({ length: ENTRIES / 2 }, (_, word) => {
    const even = values[2 * word] ?? 0;
    const odd = values[2 * word + 1] ?? 0;
    return ((0xc0 | (word << 1)) * 2 ** 24 + odd * 256 + even) >>> 0;
  });
}

export function hexDatagram(word: number): string {
  return `$${(word >>> 0).toString(16).toUpperCase().padStart(8, "0")}`;
}

export function hexList(values: readonly number[]): string {
  return datagrams(values).map(hexDatagram).join("\n");
}

export function cArray(values: readonly number[]): string {
  const rows = Array.from({ length: 8 }, (_, row) =>
    values
      .slice(row * 8, row * 8 + 8)
      .map((value) => String(value).padStart(2))
      .join(", "),
  );
  return `static const uint8_t microstep_table[64] = {\n    ${rows.join(",\n    ")}\n};\n`;
}

export type Parsed = { values: number[] } | { wrong: string };

/** Without what a C declaration has before its braces, and without comments: there may be numbers in both. */
function numbersOnly(text: string): string {
  const plain = text.replace(/\/\*[\s\S]*?\*\//g, " ").replace(/\/\/.*$/gm, " ");
  const braces = /\{([\s\S]*?)\}/.exec(plain);
  return braces?.[1] ?? plain;
}

/** 64 numbers of 0..63 in any notation, or the 32 datagrams that write them. */
export function parseTable(text: string): Parsed {
  const tokens = numbersOnly(text)
    .split(/[\s,;[\]]+/)
    .filter(Boolean);
  if (tokens.length === 0) return { wrong: "No numbers yet: 64 values of 0 to 63, or 32 datagrams." };
  const numbers: number[] = [];
  for (const token of tokens) {
    const hex = /^(?:\$|0x)([0-9a-f]+)(?:u|ul)?$/i.exec(token);
    const value = hex?.[1]
      ? Number.parseInt(hex[1], 16)
      : /^[+-]?\d+(\.\d+)?$/.test(token)
        ? Number(token)
        : Number.NaN;
    if (Number.isNaN(value)) return { wrong: `“${token.slice(0, 20)}” is not a number.` };
    numbers.push(value);
  }
  if (numbers.length === 32 && numbers.every((value) => value >= 0xc0000000)) return fromDatagrams(numbers);
  if (numbers.length !== ENTRIES) {
    return { wrong: `A table has 64 values; here ${numbers.length === 1 ? "is 1" : `are ${numbers.length}`}.` };
  }
  const bad = numbers.findIndex((value) => !Number.isInteger(value) || value < 0 || value > TOP);
  if (bad >= 0) return { wrong: `Value ${bad} is ${numbers[bad]}; each is a whole number of 0 to 63.` };
  return { values: numbers };
}

function fromDatagrams(words: readonly number[]): Parsed {
  const values = new Array<number>(ENTRIES).fill(-1);
  for (const word of words) {
    const address = (word / 2 ** 24) & 0xff;
    if ((address & 0x01) !== 0)
      return { wrong: `${hexDatagram(word)} reads; writes to the table have an even first byte.` };
    const at = (address & 0x3e) >> 1;
    values[2 * at] = word & 0x3f;
    values[2 * at + 1] = (word >> 8) & 0x3f;
  }
  const missing = values.indexOf(-1);
  return missing < 0 ? { values } : { wrong: `No datagram writes entries ${missing} and ${missing + 1}.` };
}

export function sameTable(a: readonly number[] | null, b: readonly number[] | null): boolean {
  return a !== null && b !== null && a.length === b.length && a.every((value, index) => value === b[index]);
}
