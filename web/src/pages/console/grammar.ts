import type { Schemas } from "../../api/client";
import type { RegisterRow } from "../../lib/rows/bits";

export type Command = Schemas["CommandRow"];
export type Operand = "type" | "motor" | "value";

export interface Suggestion {
  /** what takes the place of the word under the cursor */
  insert: string;
  label: string;
  detail: string;
  moves: boolean;
}

/** How far a line has come: the same grammar as the server's, which has the last word. */
export interface Parsed {
  /** the command's row; null while the first word names none */
  command: Command | null;
  /** the operands that the command takes, in order */
  operands: readonly Operand[];
  /** what is being typed: null for the command itself, else the index of the operand */
  at: number | null;
  /** the word under the cursor */
  word: string;
  /** where it begins */
  from: number;
  /** everything that is needed is there */
  complete: boolean;
}

export function commandName(command: Command): string {
  return command.mnemonic || String(command.opcode);
}

/** The operands that one writes: those that mean something to this command. */
export function operandsOf(command: Command): Operand[] {
  const described: [Operand, boolean][] = [
    ["type", command.type !== "" || Object.keys(command.types).length > 0],
    ["motor", command.motor !== ""],
    ["value", command.value !== ""],
  ];
  return described.filter(([, said]) => said).map(([operand]) => operand);
}

/** `MVP ABS|REL|COORD, motor, position`: what to write. */
export function usageOf(command: Command): string {
  const names = Object.keys(command.types);
  const parts: Record<Operand, string> = {
    type: names.length > 0 ? names.join("|") : command.type,
    motor: command.motor.replace(/[,;].*$/, ""),
    value: command.value.replace(/[;].*$/, ""),
  };
  return [
    commandName(command),
    operandsOf(command)
      .map((operand) => `‹${parts[operand]}›`)
      .join(", "),
  ]
    .filter(Boolean)
    .join(" ");
}

/** What an operand means, in the catalog's words. */
export function operandHint(command: Command, operand: Operand): string {
  if (operand === "type")
    return Object.keys(command.types).length > 0 ? Object.keys(command.types).join(", ") : command.type;
  return operand === "motor" ? command.motor : command.value;
}

export function parse(line: string, commands: readonly Command[]): Parsed {
  const text = line.replace(/^\s+/, "");
  const lead = line.length - text.length;
  const space = text.search(/\s/);
  const head = (space < 0 ? text : text.slice(0, space)).toUpperCase();
  const command =
    commands.find((row) => row.mnemonic === head && head !== "") ??
    commands.find((row) => String(row.opcode) === head) ??
    null;
  const operands = command ? operandsOf(command) : [];
  if (space < 0) {
    const complete = command !== null && operands.length === 0;
    return { command, operands, at: null, word: text, from: lead, complete };
  }
  const rest = text.slice(space);
  const parts = rest.split(",");
  const word = (parts.at(-1) ?? "").trimStart();
  const given = parts.map((part) => part.trim());
  const complete =
    given.every((part) => part !== "") && (given.length === operands.length || given.length === 3) && command !== null;
  const bare = rest.trim() === "" && operands.length === 0;
  return {
    command,
    operands,
    at: parts.length - 1,
    word,
    from: line.length - word.length,
    complete: complete || (bare && command !== null),
  };
}

const MOST = 8;

/** What could stand where the line ends, best first. */
export function suggest(line: string, commands: readonly Command[], rows: readonly RegisterRow[]): Suggestion[] {
  const parsed = parse(line, commands);
  if (parsed.at === null) return parsed.word === "" ? [] : commandSuggestions(parsed.word, commands);
  const { command, operands } = parsed;
  const operand = operands[parsed.at];
  if (command === null || operand === undefined) return [];
  const last = parsed.at === operands.length - 1;
  const found = operandSuggestions(command, operand, line, rows).filter((candidate) => fits(candidate, parsed.word));
  // what stands there already needs no proposal
  if (found.length === 1 && found[0]?.insert === parsed.word.toUpperCase()) return [];
  return found
    .slice(0, MOST)
    .map((candidate) => (last ? candidate : { ...candidate, insert: `${candidate.insert}, ` }));
}

function fits(candidate: Suggestion, word: string): boolean {
  if (word === "") return true;
  const wanted = word.toLowerCase();
  if (/^\d+$/.test(wanted)) return candidate.insert.startsWith(wanted);
  return `${candidate.label} ${candidate.detail}`.toLowerCase().includes(wanted);
}

function commandSuggestions(word: string, commands: readonly Command[]): Suggestion[] {
  const wanted = word.toLowerCase();
  const rank = (command: Command) => {
    if (commandName(command).toLowerCase().startsWith(wanted)) return 0;
    return wanted.length > 2 && command.name.toLowerCase().includes(wanted) ? 1 : 2;
  };
  const found = commands
    .filter((command) => command.direct && rank(command) < 2)
    .sort((a, b) => rank(a) - rank(b) || a.opcode - b.opcode);
  if (
    found.length === 1 &&
    found[0] &&
    commandName(found[0]) === word.toUpperCase() &&
    operandsOf(found[0]).length === 0
  )
    return [];
  return found.slice(0, MOST).map((command) => ({
    insert: commandName(command) + (operandsOf(command).length > 0 ? " " : ""),
    label: commandName(command),
    detail: command.name,
    moves: command.moves,
  }));
}

/** Which rows a command's type byte counts. */
const SPACES: Record<string, readonly RegisterRow["space"][]> = {
  SAP: ["ap"],
  GAP: ["ap"],
  AAP: ["ap"],
  SGP: ["gp0", "gp2", "gp3"],
  GGP: ["gp0", "gp2", "gp3"],
  AGP: ["gp0", "gp2", "gp3"],
  SIO: ["out", "pullup"],
  GIO: ["in", "ain", "out"],
};

/** The bank that goes with a space: as motor of SGP, GGP, SIO and GIO. */
const BANKS: Partial<Record<RegisterRow["space"], number>> = {
  gp0: 0,
  gp2: 2,
  gp3: 3,
  in: 0,
  pullup: 0,
  ain: 1,
  out: 2,
};

function operandSuggestions(
  command: Command,
  operand: Operand,
  line: string,
  rows: readonly RegisterRow[],
): Suggestion[] {
  const of = (insert: string, detail: string): Suggestion => ({ insert, label: insert, detail, moves: false });
  if (operand === "type") {
    const named = Object.entries(command.types).map(([name, code]) => of(name, String(code)));
    if (named.length > 0) return named;
    const spaces = SPACES[command.mnemonic] ?? [];
    // Hundreds of variables all called alike: their number is what one types.
    return rows
      .filter((row) => spaces.includes(row.space) && (row.space !== "gp2" || row.address < 2))
      .filter((row) => row.access !== "R" || command.reads)
      .map((row) => of(String(row.address), `${row.name.replaceAll("_", " ")}${bankText(row)}`));
  }
  if (operand === "motor") {
    const type = typedNumber(line);
    const banks = rows
      .filter((row) => (SPACES[command.mnemonic] ?? []).includes(row.space) && row.address === type)
      .flatMap((row) => {
        const bank = BANKS[row.space];
        return bank === undefined ? [] : [of(String(bank), `bank of ${row.name.replaceAll("_", " ")}`)];
      });
    if (banks.length > 0) return banks;
    return command.motor.startsWith("motor") ? [of("0", "the motor")] : [];
  }
  return valueSuggestions(command, line, rows, of);
}

function bankText(row: RegisterRow): string {
  const bank = BANKS[row.space];
  return bank === undefined || row.space === "out" ? "" : `, bank ${bank}`;
}

/** The number of the first operand, where it is one. */
function typedNumber(line: string): number | null {
  const found = /^\s*\S+\s+(\d+)\s*,/.exec(line);
  return found ? Number(found[1]) : null;
}

/** Names of the values of the parameter that is written. */
function valueSuggestions(
  command: Command,
  line: string,
  rows: readonly RegisterRow[],
  of: (insert: string, detail: string) => Suggestion,
): Suggestion[] {
  const found = /^\s*\S+\s+(\d+)\s*,\s*(\d+)\s*,/.exec(line);
  if (!found) return [];
  const [type, bank] = [Number(found[1]), Number(found[2])];
  const row = rows.find(
    (candidate) =>
      (SPACES[command.mnemonic] ?? []).includes(candidate.space) &&
      candidate.address === type &&
      (BANKS[candidate.space] ?? 0) === bank,
  );
  return Object.entries(row?.values ?? {}).map(([value, name]) => of(value, name));
}
