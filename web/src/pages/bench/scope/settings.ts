import { putIntoAddress, useAddress } from "../../../lib/address";
import { useLocalKept } from "../../../lib/useKept";
import type { Folds } from "./folding";
import { ROWS, type RowId } from "./rows";

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

const NO_ROWS = "none";
const inOrder = (rows: readonly RowId[]) => ROWS.flatMap(({ id }) => (rows.includes(id) ? [id] : [])).join();

/** Of the settings those that say what is seen, as texts of the address; "" where they are as at first. */
export function textsOf({ spanS, rows, unit }: Pick<ScopeSettings, "spanS" | "rows" | "unit">) {
  return {
    t: spanS === DEFAULTS.spanS ? "" : `-${spanS}s`,
    rows: inOrder(rows) === DEFAULTS.rows.join() ? "" : inOrder(rows) || NO_ROWS,
    unit: unit === DEFAULTS.unit ? "" : unit,
  };
}

/** The same read back: what is no such text is left out. */
export function settingsOf({ t, rows, unit }: ReturnType<typeof textsOf>): Partial<ScopeSettings> {
  const spanS = SPANS_S.find((span) => t === `-${span}s`);
  const shown = ROWS.map(({ id }) => id).filter((id) => rows.split(",").includes(id));
  const known = shown.length > 0 || rows === NO_ROWS;
  return { ...(spanS && { spanS }), ...(known && { rows: shown }), ...(unit !== "" && { unit }) };
}

/** How the scope is set: by the address, else as it was last in this browser. */
export function useScopeSettings() {
  const [stored, setStored] = useLocalKept<Partial<ScopeSettings>>("stepscope.scope", {});
  const settings: ScopeSettings = { ...DEFAULTS, ...stored, ...settingsOf(useAddress("t", "rows", "unit")) };
  const change = (part: Partial<ScopeSettings>) => {
    setStored({ ...settings, ...part });
    putIntoAddress(textsOf({ ...settings, ...part }), "replace");
  };
  return [settings, change] as const;
}
