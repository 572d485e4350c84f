import type { Device } from "../api/queries";

/** Chips hold registers; modules hold parameters, and speak commands. */
export type Family = "chip" | "module";

export function familyOf(model: Device["model"] | undefined): Family | null {
  if (model === undefined) return null;
  return model === "pd42-1241" ? "module" : "chip";
}

/** The models whose ramps, microsteps and driver chains the pages design. */
export type ChipModel = Exclude<Device["model"], "pd42-1241">;

/** The model of a chip; of a module, and without a device, null. */
export function chipModel(device: Device | undefined): ChipModel | null {
  return device === undefined || device.model === "pd42-1241" ? null : device.model;
}

/** How people call what belongs to a family. */
export const FAMILY_WORDS: Record<Family, { one: string; holds: string }> = {
  chip: { one: "a chip", holds: "registers" },
  module: { one: "a module", holds: "parameters" },
};
