import { describe, expect, it } from "vitest";
import { nameOf } from "./useRegisterMaps";

describe("the name of a register map", () => {
  it.each([
    ["Ramp_Core 2.toml", "ramp-core-2"],
    ["Übersicht.v2.csv", "ubersicht-v2"],
    ["???.toml", "map"],
    [`${"a".repeat(80)}.toml`, "a".repeat(40)],
  ])("%s is %s", (name, expected) => expect(nameOf({ name })).toBe(expected));
});
