import { describe, expect, it } from "vitest";
import {
  cArray,
  clamp,
  datagrams,
  ENTRIES,
  hexDatagram,
  hexList,
  parseTable,
  sameTable,
  withEntry,
  withStroke,
} from "./table";

/** The sheet's first formula: int(1/2 + 64 sin), and 63 where that is more. */
const sine = Array.from({ length: ENTRIES }, (_, index) =>
  Math.min(63, Math.floor(0.5 + 64 * Math.sin((Math.PI / 2) * (index / 64)))),
);

describe("a table", () => {
  it("is written by the datagrams of Table 12-2", () => {
    const words = datagrams(sine).map(hexDatagram);
    expect(words).toHaveLength(32);
    expect(words[0]).toBe("$C0000200");
    expect(words[15]).toBe("$DE002C2B");
    expect(words[16]).toBe("$E0002E2D");
    expect(words[31]).toBe("$FE003F3F");
  });

  it("comes back from what it is exported as", () => {
    expect(parseTable(hexList(sine))).toEqual({ values: sine });
    expect(parseTable(cArray(sine))).toEqual({ values: sine });
    expect(parseTable(sine.join(" "))).toEqual({ values: sine });
    expect(parseTable(datagrams(sine).reverse().map(hexDatagram).join(";"))).toEqual({ values: sine });
  });

  it("says what is wrong with a text", () => {
    const wrong = (text: string) => {
      const parsed = parseTable(text);
      return "wrong" in parsed ? parsed.wrong : null;
    };
    expect(wrong("")).toMatch(/No numbers/);
    expect(wrong(sine.slice(1).join(","))).toMatch(/64 values; here are 63/);
    expect(wrong([...sine.slice(0, 63), 64].join(","))).toMatch(/Value 63 is 64/);
    expect(wrong("1 2 three")).toMatch(/“three”/);
    expect(wrong(sine.map((value, index) => (index === 5 ? "1.5" : value)).join(" "))).toMatch(/Value 5 is 1.5/);
    const doubled = datagrams(sine);
    doubled[1] = doubled[0] as number;
    expect(wrong(doubled.map(hexDatagram).join(" "))).toMatch(/entries 2 and 3/);
  });

  it("takes a point, and a stroke of the pen either way", () => {
    expect(withEntry(sine, 0, 99)[0]).toBe(63);
    expect(clamp(-4)).toBe(0);
    const flat = new Array<number>(ENTRIES).fill(0);
    const there = withStroke(flat, { index: 10, value: 0 }, { index: 20, value: 40 });
    const back = withStroke(flat, { index: 20, value: 40 }, { index: 10, value: 0 });
    expect(there).toEqual(back);
    expect(there.slice(9, 22)).toEqual([0, 0, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 0]);
    expect(withStroke(flat, { index: 4, value: 9 }, { index: 4, value: 9 })[4]).toBe(9);
  });

  it("is the same when every value is", () => {
    expect(sameTable(sine, [...sine])).toBe(true);
    expect(sameTable(sine, withEntry(sine, 9, 0))).toBe(false);
    expect(sameTable(sine, null)).toBe(false);
  });
});
