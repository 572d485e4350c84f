import { describe, expect, it } from "vitest";
import { Hosts } from "./hosts";

describe("boxes of panels", () => {
  it("looks as its panel does now, though it is the same one", () => {
    const hosts = new Hosts();
    const box = hosts.box("scope", "host fills");
    expect(hosts.box("scope", "host")).toBe(box);
    expect(box.className).toBe("host");
  });

  it("goes to whoever shows its panel, and waits in between", () => {
    const hosts = new Hosts();
    const box = hosts.box("scope", "host");
    const [one, other] = [document.createElement("div"), document.createElement("div")];
    const end = hosts.lend("scope", one);
    expect(box.parentElement).toBe(one);
    hosts.lend("scope", other);
    end();
    expect(box.parentElement).toBe(other);
  });
});
