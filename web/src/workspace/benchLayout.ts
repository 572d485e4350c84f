import { FORMAT, type LayoutDocument, type Part, SELECTED, type Size, VERSION } from "./document";

/** A layout that comes with the program: one panel of each type, called by it. */
export function builtIn(id: string, name: string, desktop: Part, phone: readonly string[]): LayoutDocument {
  return {
    format: FORMAT,
    version: VERSION,
    id,
    name,
    revision: 0,
    screens: { desktop, phone: [...phone] },
    panels: Object.fromEntries(phone.map((type) => [type, { type, v: 1, at: SELECTED, config: {} }])),
  };
}

export const one = (id: string, size?: Size): Part => ({ tabs: [id], ...(size !== undefined && { size }) });

/** What moves the motor, and whose it is: at the left of every layout. */
export const SIDE: Part = { col: [one("motion", "content"), one("axes", 1)], size: "300px" };

/** The first page: the only layout that is there without waiting. */
export const BENCH = builtIn(
  "bench",
  "Bench",
  { row: [SIDE, { col: [one("demo", "content"), one("stage", "content"), one("limits", "content"), one("scope")] }] },
  ["motion", "demo", "stage", "limits", "scope", "axes"],
);
