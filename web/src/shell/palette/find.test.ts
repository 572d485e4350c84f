import { describe, expect, it } from "vitest";
import type { Device } from "../../api/queries";
import { page } from "../../families/family";
import { actionEntries, type Entry, helpEntries, pageEntries, registerEntries } from "./entries";
import { Index, SHOWN_MAX } from "./find";

function entry(title: string, detail = "", section = "Register"): Entry {
  return { id: `${section} ${title}`, title, section, detail, off: null, go: { to: "/" } };
}

const names = (index: Index, query: string) => index.find(query).map(({ title }) => title);

describe("what is found", () => {
  const index = new Index([
    entry("IHOLD_IRUN", "standstill and run current"),
    entry("IRUN", "IHOLD_IRUN: run current, 31 is full scale", "Field"),
    entry("CHOPCONF", "chopper of the driver"),
    entry("Encoder", "", "Page"),
    entry("ENC_CONST", "microsteps a count of the encoder"),
  ]);

  it("is what is called so before what is told so", () => {
    expect(names(index, "irun")).toEqual(["IRUN", "IHOLD_IRUN"]);
    expect(names(index, "encoder")).toEqual(["Encoder", "ENC_CONST"]);
  });
  it("has words in any order, and takes a space for an underscore", () => {
    expect(names(index, "irun ihold")).toContain("IHOLD_IRUN");
    expect(names(index, "enc const")).toEqual(["ENC_CONST"]);
    expect(names(index, "encconst")).toEqual(["ENC_CONST"]);
    expect(names(index, "current full")).toEqual(["IRUN"]);
  });
  it("forgives one letter", () => {
    expect(names(index, "chpoconf")).toEqual(["CHOPCONF"]);
  });
  it("is nothing for nothing, and for what nobody calls so", () => {
    expect(names(index, "  ")).toEqual([]);
    expect(names(index, "(((")).toEqual([]);
    expect(names(index, "zzzz")).toEqual([]);
  });
  it("is never more than fits a list", () => {
    const many = new Index(Array.from({ length: 500 }, (_, at) => entry(`REG_${at}`)));
    expect(many.find("reg")).toHaveLength(SHOWN_MAX);
  });
});

describe("what can be found", () => {
  const device = {
    title: "TMC5160",
    about: { capabilities: ["registers"] },
  } as unknown as Device;
  const registers = page(0, "/registers", "Registers", "Regs", (() => null) as never, {
    needs: ["registers"],
    topic: "settings",
  });
  const programs = page(1, "/program", "Program", "Program", (() => null) as never, { needs: ["programs"] });

  it("says why a page is not for the device", () => {
    const [one, other] = pageEntries([registers, programs], device);
    expect([one?.off, other?.off]).toEqual([null, "not for a TMC5160"]);
    expect(pageEntries([programs], undefined)[0]?.off).toBe("no device is chosen");
  });
  it("leads to a register and to a field of one, each once whatever its axis", () => {
    const row = (name: string, axis: number, ...fields: string[]) => ({
      name,
      axis,
      help: `about ${name}`,
      fields: fields.map((field) => ({ name: field, help: `about ${field}` })),
    });
    const rows = [row("V MAX", 0), row("V MAX", 1), row("IHOLD_IRUN", 0, "IHOLD", "IRUN"), row("GCONF", 0, "GCONF")];
    const model = { rows } as unknown as Parameters<typeof registerEntries>[0];
    expect(registerEntries(model, device).map(({ title, detail, go }) => [title, detail, go])).toEqual([
      ["V MAX", "about V MAX", { to: "/registers?find=V%20MAX" }],
      ["IHOLD_IRUN", "about IHOLD_IRUN", { to: "/registers?find=IHOLD_IRUN" }],
      ["IHOLD", "IHOLD_IRUN: about IHOLD", { to: "/registers?find=IHOLD_IRUN%20IHOLD" }],
      ["IRUN", "IHOLD_IRUN: about IRUN", { to: "/registers?find=IHOLD_IRUN%20IRUN" }],
      ["GCONF", "about GCONF", { to: "/registers?find=GCONF" }],
    ]);
    expect(registerEntries(model, { ...device, about: { capabilities: [] } } as unknown as Device)).toEqual([]);
    expect(registerEntries(undefined, device)).toEqual([]);
  });
  it("leads to the help's headings, with the way to them", () => {
    const item = { location: "a.html#1", title: "A", path: ["How", "A"] };
    expect(helpEntries([item]).map(({ detail, go }) => [detail, go])).toEqual([["How", { help: "a.html#1" }]]);
  });
  it("offers the other colours", () => {
    expect(actionEntries("dark").map(({ title }) => title)).toContain("Switch to light colours");
  });
});
