import type { Schemas } from "../../../api/client";

export type Model = Schemas["CoilCurrent"]["model"];

/** The chips that this page is for. */
export const MODELS: readonly Model[] = [
  "tmc5031",
  "tmc5062",
  "tmc5072",
  "tmc5130",
  "tmc5160",
  "tmc5240",
  "tmc2130",
  "tmc2209",
  "tmc2240",
];

export function modelOf(model: string | undefined): Model | null {
  return MODELS.find((candidate) => candidate === model) ?? null;
}
