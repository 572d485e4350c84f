import type { Schemas } from "../../api/client";
import type { RegisterRow } from "../../lib/rows/bits";
import { type Command, type Operand, operandHint, operandsOf, usageOf } from "../console/grammar";

/** What the editor knows of the language: the module's commands and parameters, and names that programs may include. */
export interface Words {
  commands: readonly Command[];
  rows: readonly RegisterRow[];
  /** the names of each file that a program may include, with their numbers */
  files: Readonly<Record<string, ReadonlyMap<string, number>>>;
}

export interface Proposal {
  label: string;
  /** what takes the place of the word; the label where it is not said */
  apply?: string;
  detail: string;
  info: string;
  type: "keyword" | "constant" | "variable" | "function" | "namespace";
}

export type Kind = "comment" | "command" | "label" | "number" | "name" | "include" | "unknown" | "mark";

export interface Token {
  from: number;
  to: number;
  kind: Kind;
}

const COMMENT = /\/\/|;/;
const LABEL = /^(\s*)([A-Za-z_]\w*):/;
const PIECE = /\$[0-9A-Fa-f]+|%[01]+|0[xX][0-9A-Fa-f]+|[+-]?\d+|[A-Za-z_.]\w*|[,=]/g;
const DEFINED = /^\s*(?:[A-Za-z_]\w*:)*\s*([A-Za-z_]\w*)\s*=\s*(\S+)/;
const INCLUDED = /^\s*#include\s+[<"]?([^<>"\s]+)/i;

/** The names and numbers of a file of constants. */
export function constantsOf(text: string): Map<string, number> {
  const found = new Map<string, number>();
  for (const line of text.split("\n")) {
    const [, name, number] = DEFINED.exec(line) ?? [];
    if (name && number && Number.isFinite(Number(number))) found.set(name, Number(number));
  }
  return found;
}

/** A line in pieces, by the same grammar as the server's assembler, which has the last word. */
export function tokensOf(line: string, known: (mnemonic: string) => boolean): Token[] {
  const tokens: Token[] = [];
  const comment = COMMENT.exec(line);
  const end = comment ? comment.index : line.length;
  const code = line.slice(0, end);
  let at = 0;
  if (INCLUDED.test(code)) {
    tokens.push({ from: code.search(/\S/), to: code.trimEnd().length, kind: "include" });
  } else {
    for (let label = LABEL.exec(code.slice(at)); label; label = LABEL.exec(code.slice(at))) {
      const from = at + (label[1] ?? "").length;
      tokens.push({ from, to: from + (label[2] ?? "").length + 1, kind: "label" });
      at += label[0].length;
    }
    const defines = DEFINED.test(code);
    let first = true;
    for (const piece of code.slice(at).matchAll(PIECE)) {
      const from = at + piece.index;
      const [text] = piece;
      tokens.push({ from, to: from + text.length, kind: kindOf(text, first && !defines, known) });
      first = false;
    }
  }
  if (comment) tokens.push({ from: end, to: line.length, kind: "comment" });
  return tokens;
}

function kindOf(text: string, first: boolean, known: (mnemonic: string) => boolean): Kind {
  if (text === "," || text === "=") return "mark";
  if (!/^[A-Za-z_.]/.test(text)) return "number";
  if (!first) return "name";
  return known(text) ? "command" : "unknown";
}

/** Labels that a program has, by name, with their lines from 1. */
export function labelsOf(text: string): Map<string, number> {
  const found = new Map<string, number>();
  text.split("\n").forEach((line, index) => {
    let rest = line.split(COMMENT)[0] ?? "";
    for (let label = LABEL.exec(rest); label; label = LABEL.exec(rest)) {
      found.set(label[2] ?? "", index + 1);
      rest = rest.slice(label[0].length);
    }
  });
  return found;
}

/** Names that a program may use: its own constants, and those of the files that it includes. */
export function namesOf(text: string, words: Words): Map<string, number> {
  const found = constantsOf(text);
  for (const line of text.split("\n")) {
    const [, file = ""] = INCLUDED.exec(line) ?? [];
    for (const [name, names] of Object.entries(words.files))
      if (name.toUpperCase() === file.toUpperCase()) for (const entry of names) found.set(...entry);
  }
  return found;
}

interface Place {
  /** null while the command itself is typed */
  command: Command | null;
  operand: Operand | null;
  /** what has been given before, by operand */
  given: Partial<Record<Operand, string>>;
  from: number;
  word: string;
}

/** Where in a line the cursor is; null in a comment, and where nothing can be proposed. */
export function placeIn(line: string, column: number, words: Words): Place | null {
  const before = line.slice(0, column);
  if (COMMENT.test(before)) return null;
  const word = /[#A-Za-z_.$%]?\w*$/.exec(before)?.[0] ?? "";
  const from = column - word.length;
  const label = /^(?:\s*[A-Za-z_]\w*:)*\s*/.exec(before)?.[0] ?? "";
  if (from <= label.length) return { command: null, operand: null, given: {}, from, word };
  const code = before.slice(label.length);
  const [head = ""] = code.split(/\s/, 1);
  const command = words.commands.find(({ mnemonic }) => mnemonic !== "" && mnemonic === head.toUpperCase());
  if (!command) return null;
  const parts = code.slice(head.length).split(",");
  const operands = operandsOf(command);
  const operand = operands[parts.length - 1];
  if (operand === undefined) return null;
  const given: Place["given"] = {};
  operands.forEach((each, index) => {
    if (index < parts.length - 1) given[each] = parts[index]?.trim() ?? "";
  });
  return { command, operand, given, from, word };
}

/** What could stand where the cursor is; null where nothing is to be proposed. */
export function proposalsAt(
  text: string,
  line: string,
  column: number,
  words: Words,
): { from: number; options: Proposal[] } | null {
  const place = placeIn(line, column, words);
  if (place === null) return null;
  const options = place.command === null ? beginnings(words) : operands(place, text, words);
  return options.length === 0 ? null : { from: place.from, options };
}

function beginnings(words: Words): Proposal[] {
  const commands = words.commands
    .filter(({ mnemonic }) => mnemonic !== "")
    .map((command): Proposal => {
      const spaced = operandsOf(command).length > 0 ? " " : "";
      return {
        label: command.mnemonic,
        apply: command.mnemonic + spaced,
        detail: command.name,
        info: `${usageOf(command)}\n${command.help}`,
        type: "keyword",
      };
    });
  const files = Object.keys(words.files).map(
    (name): Proposal => ({
      label: `#include ${name}`,
      detail: "names",
      info: `Names that this program may then use, such as ${[...(words.files[name]?.keys() ?? [])].slice(0, 2).join(", ")}.`,
      type: "namespace",
    }),
  );
  return [...commands, ...files];
}

function operands({ command, operand, given }: Place, text: string, words: Words): Proposal[] {
  if (command === null || operand === null) return [];
  const names = namesOf(text, words);
  const own = [...constantsOf(text)].map(
    ([label, value]): Proposal => ({
      label,
      detail: String(value),
      info: "A constant of this program.",
      type: "variable",
    }),
  );
  if (operand === "value" && command.value === "address")
    return [...labelsOf(text)].map(([label, line]) => ({
      label,
      detail: `line ${line}`,
      info: "A label of this program.",
      type: "function",
    }));
  if (operand === "type") {
    const types = Object.entries(command.types).map(
      ([label, code]): Proposal => ({
        label,
        detail: String(code),
        info: operandHint(command, operand),
        type: "constant",
      }),
    );
    if (types.length > 0) return types;
    return [...parameters(command, names, words), ...own];
  }
  if (operand === "motor") {
    const hint = operandHint(command, operand);
    const usual = hint.startsWith("motor") ? ["0"] : [...new Set(hint.match(/\d+/g) ?? [])];
    return [...usual.map((label): Proposal => ({ label, detail: hint, info: "", type: "constant" })), ...own];
  }
  const row = rowOf(command, given, names, words.rows);
  const values = Object.entries(row?.values ?? {}).map(
    ([label, detail]): Proposal => ({ label, detail, info: row?.help ?? "", type: "constant" }),
  );
  return [...values, ...own];
}

const SPACES: Readonly<Record<string, readonly [space: RegisterRow["space"], prefix: string, bank: string][]>> = {
  "axis parameter": [["ap", "AP", "0"]],
  parameter: [
    ["gp0", "GP", "0"],
    ["gp3", "GP3", "3"],
  ],
};

/** The rows that a command's type byte counts, with the prefix of their names and their bank. */
function spacesOf(command: Command) {
  return SPACES[command.type] ?? [];
}

/** As the standard file of names calls a row: `APTargetPosition`. */
export function nameOf(prefix: string, row: RegisterRow): string {
  return (
    prefix +
    row.name
      .split("_")
      .map((part) => part.charAt(0).toUpperCase() + part.slice(1).toLowerCase())
      .join("")
  );
}

function parameters(command: Command, names: ReadonlyMap<string, number>, words: Words): Proposal[] {
  if (command.type.startsWith("interrupt"))
    return Object.values(words.files)
      .flatMap((file) => [...file])
      .filter(([name]) => name.startsWith("TI_"))
      .map(([label, value]) => ({
        label,
        apply: names.has(label) ? label : String(value),
        detail: String(value),
        info: "An interrupt.",
        type: "constant",
      }));
  return spacesOf(command).flatMap(([space, prefix]) =>
    words.rows
      .filter((row) => row.space === space && (row.access !== "R" || command.reads))
      .map((row): Proposal => {
        const label = nameOf(prefix, row);
        return {
          label,
          // a name that no included file defines would be an error: then the number
          apply: names.has(label) ? label : String(row.address),
          detail: `${row.address}${row.unit ? ` [${row.unit}]` : ""}`,
          info: row.help,
          type: "constant",
        };
      }),
  );
}

/** The parameter that a command's first operands name. */
function rowOf(
  command: Command,
  given: Place["given"],
  names: ReadonlyMap<string, number>,
  rows: readonly RegisterRow[],
): RegisterRow | undefined {
  const type = given.type ?? "";
  const number = names.get(type) ?? (/^\d+$/.test(type) ? Number(type) : undefined);
  const bank = given.motor ?? "0";
  const [space] = spacesOf(command).find(([, , its]) => its === bank) ?? spacesOf(command)[0] ?? [];
  return rows.find((row) => row.space === space && row.address === number);
}

export interface Help {
  from: number;
  to: number;
  title: string;
  text: string;
}

/** What a word under the mouse means; null where nobody knows. */
export function helpAt(text: string, line: string, column: number, words: Words): Help | null {
  const known = (mnemonic: string) => words.commands.some((command) => command.mnemonic === mnemonic.toUpperCase());
  const token = tokensOf(line, known).find(({ from, to }) => from <= column && column < to);
  if (!token || token.kind === "comment" || token.kind === "mark") return null;
  const word = line.slice(token.from, token.to);
  const { from, to } = token;
  if (token.kind === "command") {
    const command = words.commands.find(({ mnemonic }) => mnemonic === word.toUpperCase());
    return command ? { from, to, title: usageOf(command), text: `${command.help} (${command.source})` } : null;
  }
  const place = placeIn(line, to, words);
  const names = namesOf(text, words);
  if (place?.command && place.operand === "type") {
    const row = rowOf(place.command, { ...place.given, type: word }, names, words.rows);
    if (row) return { from, to, title: `${row.address} ${row.name.replaceAll("_", " ")}`, text: rangeOf(row) };
    const code = place.command.types[word.toUpperCase()];
    if (code !== undefined)
      return { from, to, title: `${word.toUpperCase()} = ${code}`, text: operandHint(place.command, "type") };
  }
  const line_ = labelsOf(text).get(word.replace(":", ""));
  if (line_ !== undefined) return { from, to, title: word.replace(":", ""), text: `A label, in line ${line_}.` };
  const number = names.get(word);
  if (number !== undefined) return { from, to, title: `${word} = ${number}`, text: "A name for a number." };
  if (place?.command && place.operand)
    return { from, to, title: place.operand, text: operandHint(place.command, place.operand) };
  return null;
}

function rangeOf(row: RegisterRow): string {
  const range = row.minimum !== null && row.maximum !== null ? ` ${row.minimum} to ${row.maximum}` : "";
  return `${row.help}${range}${row.unit ? ` [${row.unit}]` : ""}`;
}

export type Problem = Schemas["ProgramProblem"];
