import type { Device, Model } from "../src/api/queries";
import catalog from "./catalog.json";

/** What the server's catalog says (`make types` writes it): tests of the page ask the same list as the page. */
export const MODELS = catalog as unknown as readonly Model[];

export function about(name: string): Model {
  const found = MODELS.find((model) => model.name === name);
  if (found === undefined) throw new Error(`the catalog has no ${name}`);
  return found;
}

/** A device of that model, as far as a test says what it is. */
export function deviceOf(name: string, more: object = {}): Device {
  return { model: name, about: about(name), ...more } as unknown as Device;
}
