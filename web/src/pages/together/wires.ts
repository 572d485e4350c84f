import type { Schemas } from "../../api/client";

export type Net = Schemas["Net"];
export type WirablePin = Schemas["WirablePin"];
export type Pin = Schemas["PinOfDevice"];

/** What names of nets are made of, as the server takes them. */
export const NET_NAME = /^[a-z0-9][a-z0-9-]{0,31}$/;

/** A pin as a choice has it: device and pin, of which no device's id has a blank. */
export function keyOf({ device, pin }: Pin): string {
  return `${device} ${pin}`;
}

/** Pins that are on no net, as choices by device. */
export function freePins(pins: readonly WirablePin[], names: Readonly<Record<string, string>>) {
  const free = pins.filter(({ nets }) => nets.length === 0);
  const devices = [...new Set(free.map(({ device }) => device))];
  return devices.map((device) => ({
    group: names[device] ?? device,
    items: free
      .filter((pin) => pin.device === device)
      .map((pin) => ({ value: keyOf(pin), label: `${names[device] ?? device} ${pin.pin}` })),
  }));
}

/** The pins of a net and those chosen besides. */
export function pinsWith(net: Net | undefined, keys: readonly string[], pins: readonly WirablePin[]): Pin[] {
  const chosen = pins.filter((pin) => keys.includes(keyOf(pin)));
  return [...(net?.pins ?? []), ...chosen].map(({ device, pin }) => ({ device, pin }));
}

/** The pins of a net without one; none where fewer than two are left, for one pin is no net. */
export function pinsWithout(net: Net, gone: Pin): Pin[] {
  const left = net.pins.filter((pin) => keyOf(pin) !== keyOf(gone)).map(({ device, pin }) => ({ device, pin }));
  return left.length < 2 ? [] : left;
}
