import { BENCH, builtIn, one, SIDE } from "./benchLayout";
import type { LayoutDocument } from "./document";

/** The layouts that every server has; "reset" goes back to them. */
export const BUILT_IN: readonly LayoutDocument[] = [
  BENCH,
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
  builtIn(
    "recording",
    "Recording",
    {
      row: [
        SIDE,
        { col: [one("stage", "content"), one("scope")] },
        { col: [one("recordings", 1), one("notes", 1)], size: "320px" },
      ],
    },
    ["motion", "recordings", "stage", "scope", "notes", "axes"],
  ),
  builtIn(
    "registers",
    "Registers",
    { row: [SIDE, one("registers"), { col: [one("changes", "content"), one("log", 1)], size: "380px" }] },
    ["motion", "registers", "changes", "log", "axes"],
  ),
  builtIn("encoder", "Encoder", { row: [SIDE, one("deviation", 3), one("polar", 2)] }, [
    "motion",
    "deviation",
    "polar",
    "axes",
  ]),
  builtIn(
    "macros",
    "Macros",
    { row: [SIDE, one("scope"), { col: [one("macros", "content"), one("log", 1)], size: "380px" }] },
    ["motion", "macros", "scope", "log", "axes"],
  ),
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

/** Every layout that there is: those that come with the program, called as they are saved, then the saved ones. */
export function allLayouts(kept: readonly { id: string; name: string }[]): { id: string; name: string }[] {
  return [...new Map([...BUILT_IN, ...kept].map(({ id, name }) => [id, { id, name }])).values()];
}
