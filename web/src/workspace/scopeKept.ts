/** How the scope is set, as a part of the layout that it stands in: put there by a save, taken from there when it opens. */
import { readLocalStorageValue } from "@mantine/hooks";
import { useEffect } from "react";
import { useSessionKept } from "../lib/useKept";
import { ROWS } from "../pages/bench/scope/rows";
import {
  RATES_HZ,
  SCOPE_KEY,
  type ScopeSettings,
  SPANS_S,
  settingsOf,
  useScopeSettings,
} from "../pages/bench/scope/settings";
import type { LayoutDocument, PanelEntry } from "./document";
import { isObject } from "./reading";

const isTexts = (value: unknown): value is string[] =>
  Array.isArray(value) && value.every((each) => typeof each === "string");
const isPlot = (value: unknown) =>
  isObject(value) &&
  typeof value.id === "string" &&
  ["time", "xy", "spectrum"].includes(String(value.kind)) &&
  isTexts(value.y);
const isAxis = (value: unknown) => isObject(value) && typeof value.device === "string" && Number.isInteger(value.axis);
const isDerived = (value: unknown) =>
  isObject(value) &&
  typeof value.formula === "string" &&
  isObject(value.inputs) &&
  isTexts(Object.values(value.inputs));

/** What of the settings makes the picture, and whether a value can be it. */
const KEPT: Partial<Record<keyof ScopeSettings, (value: unknown) => boolean>> = {
  spanS: (value) => SPANS_S.some((each) => each === value),
  rateHz: (value) => RATES_HZ.some((each) => each === value),
  rows: (value) => isTexts(value) && value.every((each) => ROWS.some(({ id }) => id === each)),
  hidden: isTexts,
  extras: (value) => Array.isArray(value) && value.every(isAxis),
  more: isTexts,
  marks: (value) => typeof value === "boolean",
  free: (value) => Array.isArray(value) && value.every(isPlot),
  derived: (value) => isObject(value) && Object.values(value).every(isDerived),
};

/** Settings out of what a layout or a browser kept; what cannot be one is left out. */
export function readScope(raw: unknown): Partial<ScopeSettings> {
  if (!isObject(raw)) return {};
  return Object.fromEntries(
    Object.entries(KEPT).flatMap(([key, fits]) => (fits(raw[key]) ? [[key, raw[key]]] : [])),
  ) as Partial<ScopeSettings>;
}

const scopesOf = ({ panels }: LayoutDocument): [string, PanelEntry][] =>
  Object.entries(panels).filter(([, { type }]) => type === "scope");

/** The layout with the scope as it is set now. */
export function withScope(document: LayoutDocument): LayoutDocument {
  const stored: unknown = readLocalStorageValue({ key: SCOPE_KEY });
  const said = new URLSearchParams(location.search);
  const [t, rows, unit] = ["t", "rows", "unit"].map((key) => said.get(key) ?? "") as [string, string, string];
  const scope = readScope({ ...(isObject(stored) && stored), ...settingsOf({ t, rows, unit }) });
  const panels = { ...document.panels };
  for (const [id, entry] of scopesOf(document)) panels[id] = { ...entry, config: { ...entry.config, scope } };
  return { ...document, panels };
}

/** Sets the scope as a layout has it, once as that is opened; what the address says goes before. */
export function useScopeOf(layout: LayoutDocument | undefined): void {
  const [settings, change] = useScopeSettings();
  const [taken, take] = useSessionKept("stepscope.scope-of", "");
  const scope = layout && readScope(scopesOf(layout)[0]?.[1].config.scope);
  const sign = `${layout?.id}/${layout?.revision}/${JSON.stringify(scope)}`;
  // biome-ignore lint/correctness/useExhaustiveDependencies: once for each layout, whatever is set since
  useEffect(() => {
    if (layout === undefined || sign === taken) return;
    take(sign);
    const said = new URLSearchParams(location.search);
    const [t, rows] = [said.get("t") ?? "", said.get("rows") ?? ""];
    if (scope && Object.keys(scope).length > 0) change({ ...settings, ...scope, ...settingsOf({ t, rows, unit: "" }) });
  }, [sign, taken]);
}
