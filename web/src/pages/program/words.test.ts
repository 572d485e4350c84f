import { describe, expect, it } from "vitest";
import type { RegisterRow } from "../../lib/rows/bits";
import type { Command } from "../console/grammar";
import { constantsOf, helpAt, labelsOf, namesOf, proposalsAt, tokensOf, type Words } from "./words";

function command(mnemonic: string, some: Partial<Command>): Command {
  return {
    opcode: 0,
    mnemonic,
    name: mnemonic.toLowerCase(),
    help: `${mnemonic} helps.`,
    source: "FM",
    types: {},
    type: "",
    motor: "",
    value: "",
    reply: "",
    direct: true,
    moves: false,
    reads: false,
    ...some,
  } as Command;
}

const row = (name: string, address: number, some: Partial<RegisterRow> = {}) =>
  ({
    name,
    address,
    space: "ap",
    access: "RW",
    unit: "",
    help: `${name} helps.`,
    minimum: 0,
    maximum: 9,
    values: {},
    ...some,
  }) as RegisterRow;

const WORDS: Words = {
  commands: [
    command("SAP", { type: "axis parameter", motor: "motor, 0", value: "value" }),
    command("GAP", { type: "axis parameter", motor: "motor, 0", reads: true }),
    command("MVP", { types: { ABS: 0, REL: 1 }, motor: "motor, 0", value: "position" }),
    command("JA", { value: "address" }),
    command("EI", { type: "interrupt, 255 for all" }),
    command("STOP", {}),
  ],
  rows: [
    row("max_speed", 4, { unit: "pps" }),
    row("actual_speed", 3, { access: "R" }),
    row("mode", 9, { values: { 0: "off", 1: "on" } }),
  ],
  files: {
    "TMCLParam.tmc": new Map([
      ["APMaxSpeed", 4],
      ["Motor0", 0],
    ]),
    "Interrupts.inc": new Map([["TI_TIMER0", 0]]),
  },
};
const known = (word: string) => WORDS.commands.some(({ mnemonic }) => mnemonic === word.toUpperCase());

function labels(text: string, more = ""): string[] {
  return (proposalsAt(more + text, text, text.length, WORDS)?.options ?? []).map(({ label }) => label);
}

describe("the pieces of a line", () => {
  it.each<[string, string]>([
    [
      "Loop: MVP ABS, 0, -5 // x, y",
      "label:Loop: command:MVP name:ABS mark:, number:0 mark:, number:-5 comment:// x, y",
    ],
    ["  rox 1 ; no", "unknown:rox number:1 comment:; no"],
    ["Speed = $1F", "name:Speed mark:= number:$1F"],
    ["#include TMCLParam.tmc", "include:#include TMCLParam.tmc"],
    ["A: B: STOP", "label:A: label:B: command:STOP"],
    ["", ""],
  ])("%s", (line, pieces) => {
    const found = tokensOf(line, known).map(({ from, to, kind }) => `${kind}:${line.slice(from, to)}`);
    expect(found.join(" ")).toBe(pieces);
  });

  it("never overlap, whatever is typed", () => {
    const letters = " ,;:/=#$%-+09AZa_.é\t";
    for (let seed = 0; seed < 2000; seed++) {
      let line = "";
      for (let at = 0; at < 12; at++) line += letters[(seed * (at + 7) * 31 + at * at * 17) % letters.length];
      let end = 0;
      for (const { from, to } of tokensOf(line, known)) {
        expect(from).toBeGreaterThanOrEqual(end);
        expect(to).toBeGreaterThan(from);
        expect(to).toBeLessThanOrEqual(line.length);
        end = to;
      }
    }
  });
});

describe("what could stand somewhere", () => {
  it("is a command or an include at the beginning, also behind a label", () => {
    expect(labels("  S")).toEqual(expect.arrayContaining(["SAP", "STOP", "#include TMCLParam.tmc"]));
    expect(labels("Loop: ")).toContain("MVP");
    expect(proposalsAt("Loop: M", "Loop: M", 7, WORDS)?.from).toBe(6);
  });

  it("is nothing in a comment, behind an unknown command, or behind the last operand", () => {
    expect(labels("STOP // S")).toEqual([]);
    expect(labels("ROX ")).toEqual([]);
    expect(labels("STOP ")).toEqual([]);
  });

  it("is a parameter that can be written, by its name where the file of names is included, else by its number", () => {
    expect(labels("SAP ")).toEqual(["APMaxSpeed", "APMode"]);
    expect(labels("GAP ")).toContain("APActualSpeed");
    const apply = (more: string) => proposalsAt(`${more}SAP `, "SAP ", 4, WORDS)?.options[0]?.apply;
    expect(apply("")).toBe("4");
    expect(apply("#include tmclparam.tmc\n")).toBe("APMaxSpeed");
    expect(labels("EI ")).toEqual(["TI_TIMER0"]);
  });

  it("is a word of the command, a motor, a value by its name, a label, a constant", () => {
    expect(labels("MVP ")).toEqual(["ABS", "REL"]);
    expect(labels("SAP 9, ")).toEqual(["0"]);
    expect(labels("SAP 9, 0, ")).toEqual(["0", "1"]);
    expect(labels("SAP 9, 0, ", "On = 1\n")).toEqual(["0", "1", "On"]);
    expect(labels("JA L", "Loop:\nLast: STOP\n")).toEqual(["Loop", "Last"]);
  });
});

it("knows labels and names", () => {
  expect([...labelsOf("A:\n // B:\nC: D: STOP")]).toEqual([
    ["A", 1],
    ["C", 3],
    ["D", 3],
  ]);
  expect(constantsOf("X = 5\nY = 0x10\nZ = Q").get("Y")).toBe(16);
  expect(namesOf('#include "Interrupts.inc"', WORDS).get("TI_TIMER0")).toBe(0);
});

describe("what a word means", () => {
  const told = (line: string, column: number, more = "") => helpAt(more + line, line, column, WORDS)?.title;
  it("is told of commands, parameters, words, labels and names", () => {
    expect(told("SAP 4, 0, 7", 1)).toBe("SAP ‹axis parameter›, ‹motor›, ‹value›");
    expect(told("SAP 4, 0, 7", 4)).toBe("4 max speed");
    expect(told("SAP APMaxSpeed, 0, 7", 8, "#include TMCLParam.tmc\n")).toBe("4 max speed");
    expect(told("MVP REL, 0, 7", 5)).toBe("REL = 1");
    expect(told("JA Loop", 4, "Loop:\n")).toBe("Loop");
    expect(told("MVP REL, 0, Far", 13, "Far = 7\n")).toBe("Far = 7");
    expect(told("MVP REL, 0, 77", 13)).toBe("value");
    expect(told("ROX // SAP", 8)).toBeUndefined();
  });
});
