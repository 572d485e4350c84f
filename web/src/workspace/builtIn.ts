import { FORMAT, type LayoutDocument, type Part, SELECTED, type Size, VERSION } from "./document";

export const BENCH = "bench";

function entry(type: string) {
  return { type, v: 1, at: SELECTED, config: {} };
}

function builtIn(id: string, name: string, desktop: Part, phone: readonly string[]): LayoutDocument {
  return {
    format: FORMAT,
    version: VERSION,
    id,
    name,
    revision: 0,
    screens: { desktop, phone: [...phone] },
    panels: Object.fromEntries(phone.map((type) => [type, entry(type)])),
  };
}

const one = (id: string, size?: Size): Part => ({ tabs: [id], ...(size !== undefined && { size }) });
/** What moves the motor, and whose it is: at the left of every layout. */
const SIDE: Part = { col: [one("motion", "content"), one("axes", 1)], size: "300px" };

/** The layouts that every server has; "reset" goes back to them. */
export const BUILT_IN: readonly LayoutDocument[] = [
  builtIn(
    BENCH,
    "Bench",
    { row: [SIDE, { col: [one("demo", "content"), one("stage", "content"), one("limits", "content"), one("scope")] }] },
    ["motion", "demo", "stage", "limits", "scope", "axes"],
  ),
  builtIn(
    "tuning",
    "Tuning",
    {
      row: [
        SIDE,
        { col: [one("stage", "content"), one("scope")] },
        { col: [one("changes"), one("notes")], size: "320px" },
      ],
    },
    ["motion", "stage", "scope", "changes", "notes", "axes"],
  ),
  builtIn("encoder", "Encoder", { row: [SIDE, one("scope", 3), one("polar", 2)] }, [
    "motion",
    "scope",
    "polar",
    "axes",
  ]),
  builtIn("view", "3D beside the scope", { row: [SIDE, one("twin", 1), one("scope", 1)] }, [
    "motion",
    "twin",
    "scope",
    "axes",
  ]),
  builtIn("wire", "Wire", { row: [SIDE, one("console", 2), one("frames", 3)] }, [
    "motion",
    "console",
    "frames",
    "axes",
  ]),
];

export function builtInOf(id: string): LayoutDocument | undefined {
  return BUILT_IN.find((layout) => layout.id === id);
}
