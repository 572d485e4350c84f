import { expect, it } from "vitest";
import { about } from "../../../test/catalog";
import type { Device } from "../../api/queries";
import { usualChannels } from "./usual";

const channel = (quantity: string, axis = 0) => ({ name: `${quantity}.${axis}`, quantity, axis, unit: "" });

it("keeps what was chosen beside the motion, as far as the device has it", () => {
  const channels = [channel("position"), channel("velocity"), channel("GCONF"), channel("GCONF", 1)];
  const device = { about: about("tmc428"), rate_max_hz: 1000, channels } as unknown as Device;
  expect(usualChannels(device, 0)).toEqual(["position.0", "velocity.0"]);
  expect(usualChannels(device, 0, ["GCONF", "CHOPCONF"])).toEqual(["position.0", "velocity.0", "GCONF.0"]);
  expect(usualChannels({ ...device, channels: [channel("GCONF")] }, 0, ["GCONF"])).toEqual(["GCONF.0"]);
});
