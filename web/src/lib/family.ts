import type { Device } from "../api/queries";

/** Chips hold registers; modules hold parameters, and speak commands. */
export type Family = "chip" | "module";

export function familyOf(model: Device["model"] | undefined): Family | null {
  if (model === undefined) return null;
  // "pd42-1241" is a drive with its controller inside; a bare chip's model has no dash
  return model.startsWith("pd") ? "module" : "chip";
}

/** How people call what belongs to a family. */
export const FAMILY_WORDS: Record<Family, { one: string; holds: string }> = {
  chip: { one: "a chip", holds: "registers" },
  module: { one: "a module", holds: "parameters" },
};
