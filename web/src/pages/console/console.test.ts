import { describe, expect, it } from "vitest";
import { register } from "../../lib/rows/samples";
import { bytesOf, replyFields, requestFields } from "./frames";
import { type Command, parse, suggest, usageOf } from "./grammar";
import { type Entry, linesOf } from "./history";
import { append, asCsv, asText, type Frame, isBad, passes } from "./log";

function command(opcode: number, mnemonic: string, name: string, more: Partial<Command> = {}): Command {
  return {
    opcode,
    mnemonic,
    name,
    types: {},
    type: "",
    motor: "",
    value: "",
    reply: "",
    direct: true,
    moves: false,
    reads: false,
    help: "",
    source: "",
    ...more,
  };
}

const MVP = command(4, "MVP", "move to position", {
  types: { ABS: 0, REL: 1, COORD: 2 },
  type: "ABS, REL or COORD",
  motor: "motor, 0",
  value: "position",
  moves: true,
});
const COMMANDS = [
  command(1, "ROR", "rotate right", { motor: "motor, 0", value: "velocity [pps]", moves: true }),
  command(3, "MST", "motor stop", { motor: "motor, 0", moves: true }),
  MVP,
  command(5, "SAP", "set axis parameter", { type: "axis parameter", motor: "motor, 0", value: "value" }),
  command(6, "GAP", "get axis parameter", { type: "axis parameter", motor: "motor, 0", reads: true }),
  command(10, "GGP", "get global parameter", { type: "parameter", motor: "bank, 0, 2 or 3", reads: true }),
  command(22, "JA", "jump always", { value: "address", direct: false }),
  command(128, "", "stop application"),
  command(136, "", "get firmware version", { types: { STRING: 0, BINARY: 1 }, type: "form", reads: true }),
];
const ROWS = [
  register("maximum_positioning_speed", 32, { address: 4, space: "ap" }),
  register("microstep_resolution", 32, { address: 140, space: "ap", values: { 0: "1", 8: "256" } }),
  register("actual_speed", 32, { address: 3, space: "ap", access: "R" }),
  register("serial_address", 32, { address: 66, space: "gp0", axis: null }),
];
const offers = (line: string) => suggest(line, COMMANDS, ROWS).map((each) => each.insert);

describe("a line of TMCL", () => {
  it("knows which operand is being typed, and when nothing is missing", () => {
    expect(parse("MV", COMMANDS)).toMatchObject({ command: null, at: null, word: "MV", complete: false });
    expect(parse("mvp rel, 0", COMMANDS)).toMatchObject({ command: MVP, at: 1, word: "0", complete: false });
    expect(parse("MVP ABS, 0, -5", COMMANDS)).toMatchObject({ at: 2, word: "-5", complete: true });
    expect(parse("MVP ABS, , 5", COMMANDS).complete).toBe(false);
    expect(parse("128", COMMANDS).complete).toBe(true);
    expect(parse("GAP 1, 0, 0", COMMANDS).complete).toBe(true);
  });

  it("is completed from names, numbers and words", () => {
    expect(offers("m")).toEqual(["MST ", "MVP "]);
    expect(offers("firm")).toEqual(["136 "]);
    expect(offers("J")).toEqual([]);
    expect(offers("")).toEqual([]);
    expect(offers("MVP ")).toEqual(["ABS, ", "REL, ", "COORD, "]);
    expect(offers("MVP r")).toEqual(["REL, ", "COORD, "]);
    expect(offers("136 s")).toEqual(["STRING"]);
  });

  it("proposes the parameters that the command can take", () => {
    expect(offers("GAP speed")).toEqual(["4, ", "3, "]);
    expect(offers("SAP speed")).toEqual(["4, "]);
    expect(offers("GAP 14")).toEqual(["140, "]);
    expect(offers("GGP 66, ")).toEqual(["0"]);
    expect(offers("SAP 140, 0, ")).toEqual(["0", "8"]);
    expect(offers("MVP ABS, 0, ")).toEqual([]);
  });

  it("says how a command is written", () => {
    expect(usageOf(MVP)).toBe("MVP ‹ABS|REL|COORD›, ‹motor›, ‹position›");
    expect(usageOf(command(128, "", "stop application"))).toBe("128");
  });
});

describe("bytes", () => {
  const request = bytesOf("010400000000c800cd");
  it("of a request are cut into its fields", () => {
    expect(requestFields(request).map(({ kind, bytes, meaning }) => [kind, bytes.join(" "), meaning])).toEqual([
      ["address", "01", "1"],
      ["command", "04", "4"],
      ["type", "00", "0"],
      ["motor", "00", "0"],
      ["value", "00 00 C8 00", "51200"],
      ["checksum", "CD", "right"],
    ]);
  });

  it("of a reply are cut into its fields, a negative value and a wrong sum told", () => {
    const fields = replyFields(request, bytesOf("02016404ffffffff00"));
    expect(fields.map((field) => field.kind)).toEqual(["host", "address", "status", "command", "value", "checksum"]);
    expect(fields.at(-2)?.meaning).toBe("-1");
    expect(fields.at(-1)?.meaning).toBe("wrong");
  });

  it("of the version string are text", () => {
    const asked = bytesOf("018800000000000089");
    expect(replyFields(asked, bytesOf("02313234315631343434".slice(0, 18))).at(-1)?.meaning).toBe("1241V144");
    // refused: an answer like any other
    expect(replyFields(asked, bytesOf("0201048800000000".concat("8f"))).map((field) => field.kind)).toContain("status");
  });
});

describe("history", () => {
  it("gives each line once in a row, newest first", () => {
    const entry = (line: string): Entry => ({ id: 1, atMs: 0, line, answer: null, problem: null });
    expect(linesOf(["GAP 1, 0", "GAP 1, 0", "MST 0", "GAP 1, 0"].map(entry))).toEqual([
      "GAP 1, 0",
      "MST 0",
      "GAP 1, 0",
    ]);
  });
});

function frame(seq: number, more: Partial<Frame> = {}): Frame {
  return {
    seq,
    time_unix_s: 1_700_000_000.25,
    priority: "command",
    tx: "0106010000000000",
    rx: "0201640600000005",
    took_ms: 1.5,
    text: "GAP 1, 0 -> 5",
    error: null,
    ...more,
  };
}

describe("the frame log", () => {
  it("takes each frame once, and drops old samples before what people did", () => {
    const log = append([frame(0), frame(1, { priority: "sample", error: "no reply" })], [frame(1), frame(2)]);
    expect(log.map((each) => each.seq)).toEqual([0, 1, 2]);
    const flood = Array.from({ length: 5000 }, (_, index) => frame(index + 3, { priority: "sample" }));
    const kept = append(log, flood);
    expect(kept.slice(0, 3).map((each) => each.seq)).toEqual([0, 1, 2]);
    expect(kept).toHaveLength(2003);
    expect(kept.at(-1)?.seq).toBe(5002);
  });

  it("filters by text, kind and failure", () => {
    const all = { text: "", show: "all", errorsOnly: false } as const;
    const refused = frame(1, { text: "SAP 4, 0, -1 -> invalid value (4)" });
    expect(isBad(refused)).toBe(true);
    expect(isBad(frame(2))).toBe(false);
    expect(passes(frame(1), { ...all, errorsOnly: true })).toBe(false);
    expect(passes(refused, { ...all, errorsOnly: true })).toBe(true);
    expect(passes(frame(1), { ...all, text: "gap 0201" })).toBe(true);
    const ticks = frame(1, { text: "GGP 132, 0 -> 1633", tx: "010a8400000000008f", rx: "0201640a00000661d8" });
    expect(passes(ticks, { ...all, text: "ggp 66" })).toBe(false);
    expect(passes(ticks, { ...all, text: "ggp 0661" })).toBe(true);
    expect(passes(frame(1, { priority: "sample" }), { ...all, show: "commands" })).toBe(false);
    expect(passes(frame(1, { priority: "stop" }), { ...all, show: "samples" })).toBe(false);
  });

  it("is copied as text and as a table", () => {
    expect(asText([frame(7, { rx: null, error: "no reply in 0.25 s" })])).toMatch(
      /command {2}> 01 06 01.* {2}< nothing {2}1\.50 ms {2}GAP 1, 0 -> 5 {2}no reply in 0\.25 s$/,
    );
    expect(asCsv([frame(7)]).split("\n")[1]).toBe(
      '7,1700000000.25,command,0106010000000000,0201640600000005,1.5,"GAP 1, 0 -> 5",',
    );
  });
});
