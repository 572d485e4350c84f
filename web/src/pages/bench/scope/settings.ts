import { useLocalKept } from "../../../lib/useKept";
import type { Folds } from "./folding";
import type { RowId } from "./rows";

export type Trigger = "roll" | "auto" | "single";

/** An axis whose traces are added to those of the selected one. */
export interface ExtraAxis {
  device: string;
  axis: number;
}

export interface ScopeSettings {
  spanS: number;
  rateHz: number;
  unit: string;
  trigger: Trigger;
  rows: RowId[];
  /** channels switched off, by quantity */
  hidden: string[];
  extras: ExtraAxis[];
  /** further registers or parameters, by name */
  more: string[];
  folds: Folds;
}

export const SPANS_S = [0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300] as const;
export const RATES_HZ = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000] as const;

const DEFAULTS: ScopeSettings = {
  spanS: 10,
  rateHz: 500,
  unit: "microsteps",
  trigger: "roll",
  rows: ["position", "residual", "deviation", "velocity", "acceleration", "load", "switches"],
  hidden: ["external_encoder_position", "external_deviation", "measured_speed"],
  extras: [],
  more: [],
  folds: {},
};

/** What the page keeps of samples [s]: less when they come fast. */
export function keepS(rateHz: number): number {
  return rateHz > 200 ? 60 : 300;
}

/** How the scope is set, kept in the browser. */
export function useScopeSettings() {
  const [stored, setStored] = useLocalKept<Partial<ScopeSettings>>("stepscope.scope", {});
  const settings: ScopeSettings = { ...DEFAULTS, ...stored };
  const change = (part: Partial<ScopeSettings>) => setStored((before) => ({ ...before, ...part }));
  return [settings, change] as const;
}
