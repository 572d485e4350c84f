import { expect, it } from "vitest";
import { about } from "../../../test/catalog";
import type { Device } from "../../api/queries";
import { topOf, zeroOf } from "./roles";

function device(model: "tmc428" | "pd42-1241", ...names: string[]): Device {
  const channels = names.map((name) => {
    const at = name.lastIndexOf(".");
    return { name, quantity: name.slice(0, at), axis: Number(name.slice(at + 1)), unit: "" };
  });
  return { about: about(model), channels } as unknown as Device;
}

it("finds the top speed by the names that there are, on the axis that is asked for", () => {
  const chip = device("tmc428", "TVMAX.0", "VMAX.0", "M1_TVMAX.1", "M1_VMAX.1");
  expect([topOf(chip, 0)?.name, topOf(chip, 1)?.name, topOf(chip, 2)]).toEqual(["VMAX", "M1_VMAX", null]);
  expect(topOf(device("pd42-1241", "MaxPositioningSpeed.0"), 0)?.name).toBe("MaxPositioningSpeed");
});

it("takes a chip out of following its target while zero is set", () => {
  const own = device("tmc428", "RAMPMODE.1", "XACTUAL.1", "XTARGET.1");
  expect(zeroOf(own, 1)).toEqual([
    { name: "RAMPMODE", value: 3 },
    { name: "XACTUAL", value: 0 },
    { name: "XTARGET", value: 0 },
    { name: "RAMPMODE", value: 0 },
  ]);
  expect(zeroOf(own, 0)).toEqual([]);
});

it("writes its own field of a mode that axes share", () => {
  const names = ["RAMPMODE.0", "RAMPMODE.RAMPMODE_M1_RAMPMODE.0", "M1_XACTUAL.1", "M1_XTARGET.1"];
  const writes = zeroOf(device("tmc428", ...names), 1);
  expect(writes[0]).toEqual({ name: "RAMPMODE", fields: { RAMPMODE_M1_RAMPMODE: 3 } });
  expect(writes[3]).toEqual({ name: "RAMPMODE", fields: { RAMPMODE_M1_RAMPMODE: 0 } });
});

it("stops a module from following its target", () => {
  expect(zeroOf(device("pd42-1241"), 0).map(({ name }) => name)).toEqual(["TargetVelocity", "ActualPosition"]);
});
