import { describe, expect, it } from "vitest";
import { sizeText } from "../../lib/format";
import type { Mark, Recording } from "./api";
import { lanesOf } from "./channels";
import { colorOfMark, flagsOf } from "./flags";
import { order, whenText } from "./words";

const BASE: Recording = {
  id: "20261121-184500-0001",
  name: "b",
  note: "",
  tags: [],
  colour: "",
  device: "bench",
  model: "tmc428",
  channels: [],
  rate_hz: 100,
  started_unix_s: 1,
  state: "done",
  message: "",
  rows: null,
  size_bytes: 10,
};

describe("the list", () => {
  it("is sorted both ways, with running ones on top", () => {
    const all: Recording[] = [
      BASE,
      { ...BASE, id: "20261121-184500-0002", name: "A", started_unix_s: 3 },
      { ...BASE, id: "20261121-184500-0003", name: "c", started_unix_s: 2, state: "recording" },
    ];
    const names = (sort: Parameters<typeof order>[1]) => order(all, sort).map(({ name }) => name);
    expect(names({ key: "name", down: false })).toEqual(["c", "A", "b"]);
    expect(names({ key: "name", down: true })).toEqual(["c", "b", "A"]);
    expect(names({ key: "started_unix_s", down: true })).toEqual(["c", "A", "b"]);
  });

  it("says sizes and times as people do", () => {
    expect([640, 64_000, 46.4e6, 2.5e9].map(sizeText)).toEqual([
      "640\u202fB",
      "64\u202fkB",
      "46.4\u202fMB",
      "2.5\u202fGB",
    ]);
    expect(whenText(null)).toBe("–");
  });
});

describe("plots", () => {
  const channel = (quantity: string, axis: number, unit: string) => ({
    name: `${quantity}.${axis}`,
    quantity,
    axis,
    unit,
  });

  it("put what is read against each other into one, the measured on top of the planned", () => {
    const lanes = lanesOf(
      [
        channel("velocity", 0, "pps"),
        channel("position", 0, "microsteps"),
        channel("predicted_position", 0, "microsteps"),
        channel("position", 1, "microsteps"),
        channel("humidity", 0, "%"),
      ],
      "light",
    );
    expect(lanes.map(({ title, columns }) => [title, columns])).toEqual([
      ["Position", [2, 1, 3]],
      ["Velocity", [0]],
      ["humidity", [4]],
    ]);
    const [planned, first, second] = lanes[0]?.series ?? [];
    expect(second?.color).toBe(`${first?.color}a6`);
    expect(planned?.color).not.toBe(first?.color);
  });
});

describe("flags", () => {
  const mark = (kind: string, time_s: number, text = kind): Mark => ({ kind, time_s, text, axis: null, detail: null });

  it("stand at their time since the zero, those in view alone", () => {
    const flags = flagsOf([mark("note", 12), mark("command", 14)], 10, "light");
    expect(flags([1, 3], true)).toMatchObject([{ x: 2, label: "note", fixed: true }]);
    expect(flags([0, 5], false).every(({ label }) => label === undefined)).toBe(true);
  });

  it("do not lie on each other: what matters is named", () => {
    const together = [mark("command", 5), mark("trigger", 5), mark("move", 5.1), mark("write", 8)];
    const named = flagsOf(together, 0, "light")([0, 10], true).filter(({ label }) => label !== undefined);
    expect(named.map(({ label }) => label)).toEqual(["trigger", "write"]);
  });

  it("lose their words where there are too many, but for those that matter", () => {
    const many = Array.from({ length: 1000 }, (_, index) => mark("write", index / 100));
    const flags = flagsOf([...many, mark("trigger", 5)], 0, "light")([0, 10], true);
    expect(flags).toMatchObject([{ label: "trigger" }]);
  });

  it("are red for faults alone", () => {
    expect(colorOfMark(mark("stopped", 0, "stall detected"), "light")).toBe("#c92a2a");
    expect(colorOfMark(mark("stopped", 0, "target reached"), "light")).toBe("#6b7280");
  });
});
