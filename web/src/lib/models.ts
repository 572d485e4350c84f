import { type Capability, type Model, useCatalog } from "../api/queries";

/** Models by the name of their family, in the order of the catalog. */
export function byFamily(models: readonly Model[]): Map<string, Model[]> {
  const found = new Map<string, Model[]>();
  for (const model of models) found.set(model.family, [...(found.get(model.family) ?? []), model]);
  return found;
}

/** Letters that titles have to share to be told by them. */
const SHARED_LEAST = 3;

/** What titles have in common: of a TMC5031 and a TMC5160 "TMC5xxx"; "modules" of modules, whose names differ. */
export function commonTitle(models: readonly Model[]): string {
  const [first = "", ...rest] = models.map(({ title }) => title);
  const same = [...first].findIndex((letter, at) => rest.some((title) => title[at] !== letter));
  if (same >= 0 && same < SHARED_LEAST) return models.every(({ kind }) => kind === "module") ? "modules" : "chips";
  return same < 0 ? first : `${first.slice(0, same)}${"x".repeat(first.length - same)}`;
}

/** The models that can that, by one title a family: "TMC4361", "TMC5xxx". */
export function useWhoCan(capability: Capability): string[] {
  const models = useCatalog().data?.filter(({ capabilities }) => capabilities.includes(capability)) ?? [];
  return [...byFamily(models).values()].map(commonTitle);
}
