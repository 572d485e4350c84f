import type { Capability, Model } from "../../api/queries";

export type { Model } from "../../api/queries";
export { TIERS } from "../../lib/tiers";
export type Kind = Model["wires"][number]["kind"];

/** How many axes a model has; of one without any, what it has instead. */
export function axesText(axes: number): string {
  if (axes === 0) return "registers only";
  return axes === 1 ? "1 axis" : `${axes} axes`;
}

export function canModel(model: Model, capability: Capability): boolean {
  return model.capabilities.includes(capability);
}

export function isModule(model: Model): boolean {
  return model.kind === "module";
}

/** The kinds of link that lead to that model, in the order in which one chooses. */
export function kindsOf(model: Model): { value: Kind; label: string }[] {
  return model.wires.map(({ kind, title }) => ({ value: kind, label: title }));
}
