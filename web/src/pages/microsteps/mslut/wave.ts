import type { Schemas } from "../../../api/client";
import { FAMILIES } from "../../../families/families";
import type { Phases } from "../../../families/family";

/** The microstep table of one-bit differences (MSLUT): a quarter wave of 256 values of 0..255. */
export const ENTRIES = 256;
export const POSITIONS = 1024;
export const TOP = 255;
/** Half of the default wave's height: what a formula's amplitude is by default. */
export const FULL = 248;
export const SEGMENTS = 4;

export type Grid = "complement" | "opposite" | "whole_step";
export type Norm = Schemas["MslutNearest"]["norm"];
export type Table = Schemas["MslutTable"];
export type Register = Schemas["MslutRegister"];
export type Design = Schemas["MslutDesign"];

/** What the chip's data sheet calls the phase that has the sine, and the one that has the cosine. */
export function phasesOf(family: string | undefined, model = ""): Phases {
  const phases = FAMILIES[family ?? ""]?.phases ?? { sine: "phase A", cosine: "phase B" };
  return typeof phases === "function" ? phases(model) : phases;
}

export interface Part {
  order: number;
  /** of the amplitude for a harmonic, electrical degrees for a correction */
  amount: number;
  phase_deg: number;
}

export interface Formula {
  sigma: number;
  exponent: number;
  harmonics: readonly Part[];
  corrections: readonly Part[];
  /** null: the grid's own, 248 or 247 */
  amplitude: number | null;
  full_scale: boolean;
  grid: Grid;
}

export type Origin = "hand" | "chip" | "pasted" | "nearest";
/** A wave by formula, or one drawn, pasted or read as numbers; `mirror - value` is its negative half. */
export type Draft =
  | { kind: "formula"; formula: Formula }
  | { kind: "values"; values: number[]; mirror: number; origin: Origin };

const parts = (orders: readonly number[]): Part[] => orders.map((order) => ({ order, amount: 0, phase_deg: 0 }));

export const DEFAULT: Formula = {
  sigma: 0,
  exponent: 1,
  harmonics: parts([3, 5, 7]),
  corrections: parts([4, 8]),
  amplitude: null,
  full_scale: false,
  grid: "complement",
};

export const PRESETS: readonly { name: string; formula: Formula }[] = [
  { name: "Power-on wave", formula: DEFAULT },
  { name: "Truest sine (opposite halves)", formula: { ...DEFAULT, grid: "opposite" } },
  { name: "Linearity correction 30 (firmware)", formula: { ...DEFAULT, exponent: 1.03, grid: "whole_step" } },
  { name: "Linearity correction 100 (firmware)", formula: { ...DEFAULT, exponent: 1.1, grid: "whole_step" } },
  { name: "Linearity correction 200 (firmware)", formula: { ...DEFAULT, exponent: 1.2, grid: "whole_step" } },
  { name: "Against 2 % torque ripple, f 1.06", formula: { ...DEFAULT, exponent: 1.06, grid: "opposite" } },
  { name: "Towards box, σ +0.25", formula: { ...DEFAULT, sigma: 0.25 } },
  { name: "Towards rhomb, σ −0.25", formula: { ...DEFAULT, sigma: -0.25 } },
  { name: "Box, σ +1", formula: { ...DEFAULT, sigma: 1 } },
  { name: "Rhomb, σ −1", formula: { ...DEFAULT, sigma: -1 } },
];

/** The exponent that cancels a torque ripple of fourth order, r of the motor's torque: 1 + 3r. And back. */
export const exponentFor = (ripple: number): number => 1 + 3 * ripple;
export const rippleOf = (exponent: number): number => (exponent - 1) / 3;

/** What the calculator is asked for a draft. */
export function questionOf(draft: Draft, norm: Norm, chip: Design["chip"]): Partial<Design> {
  if (draft.kind === "values") return { chip, values: draft.values, mirror: draft.mirror, norm };
  const { harmonics, corrections, ...rest } = draft.formula;
  return {
    ...rest,
    chip,
    norm,
    harmonics: harmonics
      .filter((part) => part.amount !== 0)
      .map(({ order, amount, phase_deg }) => ({ order, amplitude: amount, phase_deg })),
    corrections: corrections
      .filter((part) => part.amount !== 0)
      .map(({ order, amount, phase_deg }) => ({ order, degrees: amount, phase_deg })),
  };
}

/** The entry that a position of the period reads, and whether it reads it in the negative half. */
export function entryAt(position: number): { index: number; negative: boolean } {
  const within = ((position % POSITIONS) + POSITIONS) % POSITIONS;
  const half = within % (2 * ENTRIES);
  return { index: half < ENTRIES ? half : 2 * ENTRIES - 1 - half, negative: within >= 2 * ENTRIES };
}

/** Current of phase A at a position of the period; phase B is 256 positions ahead. */
export function currentAt(values: readonly number[], mirror: number, position: number): number {
  const { index, negative } = entryAt(position);
  const value = values[index] ?? 0;
  return negative ? mirror - value : value;
}

export function period(values: readonly number[], mirror: number, ahead = 0): number[] {
  return Array.from({ length: POSITIONS }, (_, position) => currentAt(values, mirror, position + ahead));
}

/** The sine that the power-on wave rounds, as table values. */
export const SINE: readonly number[] = Array.from(
  { length: ENTRIES },
  (_, index) => FULL * Math.sin((2 * Math.PI * (index + 0.5)) / POSITIONS) - 0.5,
);

export function clamp(value: number): number {
  return Math.min(TOP, Math.max(0, Math.round(value)));
}

/** How many entries to either side follow a point that is bent away. */
export const BEND = 40;

/** With one entry moved and its neighbours following along a raised cosine: keeps differences small. */
export function bent(values: readonly number[], index: number, to: number): number[] {
  const by = to - (values[index] ?? 0);
  return values.map((value, at) => {
    const away = Math.abs(at - index);
    return away >= BEND ? value : clamp(value + by * 0.5 * (1 + Math.cos((Math.PI * away) / BEND)));
  });
}

/** The wave that register words make: bit i says by which of its segment's two amounts entry i differs. */
export function decode(words: readonly number[], select: number, start: number): { values: number[]; mirror: number } {
  const borders = [8, 16, 24].map((shift) => (select >>> shift) & 0xff);
  const difference = (index: number) => {
    const segment = borders.filter((border) => index >= border).length;
    return ((select >>> (2 * segment)) & 3) - 1 + (((words[index >> 5] ?? 0) >>> (index & 31)) & 1);
  };
  const values = [start & 0xff];
  for (let index = 1; index < ENTRIES; index++) values.push((values[index - 1] ?? 0) + difference(index));
  return { values, mirror: 2 * (start & 0xff) - difference(0) };
}

const hex = (value: number, digits: number) => value.toString(16).toUpperCase().padStart(digits, "0");

export function hexLines(registers: readonly Register[]): string {
  return `${registers.map((row) => `0x${hex(row.address, 2)} 0x${row.hex}`).join("\n")}\n`;
}

export function cArray(registers: readonly Register[]): string {
  const rows = registers.map((row) => `    {0x${hex(row.address, 2)}, 0x${row.hex}},  /* ${row.name} */`);
  return `/* register address, value */\nstatic const uint32_t microstep_table[${registers.length}][2] = {\n${rows.join("\n")}\n};\n`;
}

export type Parsed = { values: number[]; mirror: number } | { wrong: string };

/** Without what a C declaration has before its braces, and without comments: there may be numbers in both. */
function numbersOnly(text: string): string {
  const plain = text.replace(/\/\*[\s\S]*?\*\//g, " ").replace(/\/\/.*$/gm, " ");
  return /=\s*([\s\S]*)/.exec(plain)?.[1] ?? plain;
}

/** 256 values; or the ten register words in their order, with or without their addresses. */
export function parseWave(text: string): Parsed {
  const tokens = numbersOnly(text)
    .split(/[\s,;{}[\]()]+/)
    .filter(Boolean);
  if (tokens.length === 0) return { wrong: "No numbers yet: 256 values of 0 to 255, or the ten register words." };
  const numbers: number[] = [];
  for (const token of tokens) {
    const digits = /^(?:\$|0x)([0-9a-f]+)(?:u|ul)?$/i.exec(token)?.[1];
    const value = digits ? Number.parseInt(digits, 16) : /^[+-]?\d+(\.\d+)?$/.test(token) ? Number(token) : Number.NaN;
    if (Number.isNaN(value)) return { wrong: `“${token.slice(0, 20)}” is not a number.` };
    numbers.push(value);
  }
  if (numbers.length === ENTRIES) {
    const bad = numbers.findIndex((value) => !Number.isInteger(value) || value < 0 || value > TOP);
    if (bad >= 0) return { wrong: `Value ${bad} is ${numbers[bad]}; each is a whole number of 0 to ${TOP}.` };
    return { values: numbers, mirror: -1 };
  }
  const words = numbers.length === 20 ? numbers.filter((_, at) => at % 2 === 1) : numbers;
  if (words.length !== 10) {
    return { wrong: `A wave has 256 values or ten register words; here are ${numbers.length} numbers.` };
  }
  const wide = words.findIndex((word) => !Number.isInteger(word) || word < 0 || word > 0xffffffff);
  if (wide >= 0) return { wrong: `Word ${wide} is ${words[wide]}; a register has 32 bits.` };
  return decode(words.slice(0, 8), words[8] ?? 0, words[9] ?? 0);
}

export function sameRegisters(a: readonly Register[] | undefined, b: readonly Register[] | undefined): boolean {
  return a !== undefined && b !== undefined && a.every((row, at) => row.value === b[at]?.value);
}

/** The same wave, whatever segments it is cut into. */
export function sameWave(a: Table | null | undefined, b: Table | null | undefined): boolean {
  return !!a && !!b && a.mirror === b.mirror && a.values.every((value, at) => value === b.values[at]);
}

/** The registers as a write takes them. */
export function wordsOf(registers: readonly Register[]): Schemas["MslutWords"] {
  const values = registers.map((row) => row.value);
  return { mslut: values.slice(0, 8), mslutsel: values[8] ?? 0, mslutstart: values[9] ?? 0 };
}

/** A hue of ui.css for each two differences that a segment may hold: the same four everywhere, words beside them. */
export const WIDTH_HUES = ["hue-pink", "hue-blue", "hue-green", "hue-orange"] as const;

/** "0 +1": the two differences of a segment. */
export function pairOf(low: number): string {
  const signed = (step: number) => (step > 0 ? `+${step}` : step < 0 ? `−${-step}` : "0");
  return `${signed(low)} ${signed(low + 1)}`;
}
