import { describe, expect, it } from "vitest";
import { freePins, type Net, pinsWith, pinsWithout, type WirablePin } from "./wires";

const PINS: WirablePin[] = [
  { device: "left", pin: "START", role: "level", nets: ["go"] },
  { device: "left", pin: "STEP1", role: "output", nets: [] },
  { device: "right", pin: "START", role: "level", nets: ["go"] },
  { device: "third", pin: "START", role: "level", nets: [] },
];
const net = (...devices: string[]) =>
  ({ net: "go", pins: devices.map((device) => ({ device, pin: "START", role: "level" })) }) as Net;

describe("wires", () => {
  it("offers the pins that are on no net, by the names of their devices", () => {
    expect(freePins(PINS, { left: "Left one" })).toEqual([
      { group: "Left one", items: [{ value: "left STEP1", label: "Left one STEP1" }] },
      { group: "third", items: [{ value: "third START", label: "third START" }] },
    ]);
  });

  it("adds to a net what was chosen", () => {
    expect(pinsWith(net("left", "right"), ["third START"], PINS).map(({ device }) => device)).toEqual([
      "left",
      "right",
      "third",
    ]);
    expect(pinsWith(undefined, ["left STEP1"], PINS)).toEqual([{ device: "left", pin: "STEP1" }]);
  });

  it("has no net left of one pin", () => {
    const gone = { device: "left", pin: "START" };
    expect(pinsWithout(net("left", "right", "third"), gone).map(({ device }) => device)).toEqual(["right", "third"]);
    expect(pinsWithout(net("left", "right"), gone)).toEqual([]);
  });
});
