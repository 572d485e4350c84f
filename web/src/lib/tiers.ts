import type { Model } from "../api/queries";

/** What it means that a model is known by the list of the maker's package. */
const NAMES_ONLY = "Names of registers or parameters known, no calculators, no physical emulator";

/** What beside a model's title says how deep it is known. */
export const TIERS: Record<Model["tier"], { word: string; help: string } | null> = {
  full: null,
  names: { word: "names only", help: NAMES_ONLY },
  map: {
    word: "your map",
    help: "Registers as a register map of this server names them, no calculators, no physical emulator",
  },
};
