import { describe, expect, it } from "vitest";
import { Gutters } from "./gutters";

describe("gutters of a stack", () => {
  it("are as wide as the widest needs, and the others hear of it", () => {
    const heard: string[] = [];
    const gutters = new Gutters<string>((member) => heard.push(member));
    gutters.claim("load", { left: 56, right: 14 });
    gutters.claim("current", { left: 56, right: 68 });
    expect([gutters.left, gutters.right]).toEqual([56, 68]);
    expect(heard).toEqual(["load"]);
    gutters.claim("load", { left: 56, right: 14 });
    expect(heard).toEqual(["load"]);
    gutters.claim("load", { left: 80, right: 14 });
    expect([gutters.left, gutters.right]).toEqual([80, 68]);
    expect(heard).toEqual(["load", "current"]);
  });

  it("do not shrink while labels come and go, but with the plot that needed them", () => {
    const gutters = new Gutters<string>(() => undefined);
    gutters.claim("a", { left: 80, right: 14 });
    gutters.claim("a", { left: 56, right: 14 });
    gutters.claim("b", { left: 60, right: 14 });
    expect(gutters.left).toBe(80);
    gutters.leave("a");
    expect(gutters.left).toBe(60);
  });
});
