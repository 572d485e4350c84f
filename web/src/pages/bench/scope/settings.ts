import { useRef } from "react";
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

/** A plot that the user has put together: channels by path, `xy:velocity.1` or `=:slip`. */
export interface FreePlot {
  id: string;
  /** over time; all over the first of them; or what they swing at */
  kind: "time" | "xy" | "spectrum";
  y: string[];
}

/** A channel that is worked out of others: the letters of a formula, and the channels that they are. */
export interface Derived {
  formula: string;
  inputs: Record<string, string>;
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
  free: FreePlot[];
  derived: Record<string, Derived>;
  /** what was written, and how motors stopped, as marks */
  marks: boolean;
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
  free: [],
  derived: {},
  marks: false,
};

/** What the page keeps of samples [s]: less when they come fast. */
export function keepS(rateHz: number): number {
  return rateHz > 200 ? 60 : 300;
}

export const SCOPE_KEY = "stepscope.scope";

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

/** Whether `t` of the address is the stretch of a scope that stands still: `3.2~4.9`. */
export function isStretch(t: string): boolean {
  return t.includes("~");
}

/** Puts what is seen into the address; where that holds a stretch of time, this stays. */
export function putSettings(settings: ScopeSettings): void {
  const { t, ...others } = textsOf(settings);
  const said = new URLSearchParams(location.search).get("t") ?? "";
  putIntoAddress(isStretch(said) ? others : { t, ...others }, "replace");
}

/** How the scope is set: by the address, else as it was last in this browser. */
export function useScopeSettings() {
  const [stored, setStored] = useLocalKept<Partial<ScopeSettings>>(SCOPE_KEY, {});
  const address = useAddress("t", "rows", "unit");
  const settings: ScopeSettings = { ...DEFAULTS, ...stored, ...settingsOf(address) };
  // a paused scope has its stretch in the place of its span, which it goes on with
  const span = useRef(settings.spanS);
  if (isStretch(address.t)) settings.spanS = span.current;
  else span.current = settings.spanS;
  const change = (part: Partial<ScopeSettings>) => {
    setStored({ ...settings, ...part });
    putSettings({ ...settings, ...part });
  };
  return [settings, change] as const;
}
