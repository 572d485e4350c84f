import type { Capability, Model } from "../../api/queries";
import type { Limits } from "./limits";

export type { Model } from "../../api/queries";
export type Kind = Model["wires"][number]["kind"];

/** What it means that a model is known by the list of the maker's package. */
export const NAMES_ONLY = "Names of parameters known, no calculators, no physical emulator";

export function canModel(model: Model, capability: Capability): boolean {
  return model.capabilities.includes(capability);
}

export function isModule(model: Model): boolean {
  return model.kind === "module";
}

/** The chip's clock as the catalog has its range. */
export function clockLimits(model: Model): Limits {
  const [minimum, maximum] = [model.clock_hz_min / 1e6, model.clock_hz_max / 1e6];
  return { minimum, above: minimum === 0, maximum, fallback: model.clock_hz_default / 1e6 };
}

/** The kinds of link that lead to that model, in the order in which one chooses. */
export function kindsOf(model: Model): { value: Kind; label: string }[] {
  return model.wires.map(({ kind, title }) => ({ value: kind, label: title }));
}

/** What goes over a kind of link: a chip's datagrams, those of its UART, an evaluation board's commands, TMCL. */
export function framesOf(model: Model, kind: Kind): Model["wires"][number]["frames"] | undefined {
  return model.wires.find((wire) => wire.kind === kind)?.frames;
}
