import type { Mark as PlotMark } from "../../plots/types";
import type { Mark } from "./api";
import type { Window } from "./ZoomData";

/** More flags than this in one view are lines without words: zooming in names them. */
const NAMED_MAX = 24;
/** More lines than this would be a grey wall. */
const DRAWN_MAX = 300;
const TEXT_MAX = 26;
/** A flag takes so much of the plot's width, about. */
const APART = 0.11;

const COLORS: Record<string, readonly [light: string, dark: string]> = {
  trigger: ["#1c6dd0", "#4d94e8"],
  note: ["#4b2fa3", "#8b74e0"],
  program: ["#0b7285", "#2a8fa3"],
  gap: ["#8a5700", "#a87414"],
  fault: ["#c92a2a", "#d64545"],
  other: ["#6b7280", "#6b7280"],
};
/** How a motor came to rest that nobody had asked to. */
const FAULTS = /stall|switch|lost|limit|fault|deviat/i;

type Flagged = Pick<Mark, "time_s" | "kind" | "text">;

export function colorOfMark({ kind, text }: Flagged, scheme: "light" | "dark"): string {
  const name = kind === "stopped" && FAULTS.test(text) ? "fault" : kind in COLORS ? kind : "other";
  return (COLORS[name] ?? COLORS.other)?.[scheme === "light" ? 0 : 1] ?? "#6b7280";
}

/** The marks of a recording as flags of its plots: those in view, with their words where there are few. */
export function flagsOf(marks: readonly Flagged[], zero: number, scheme: "light" | "dark") {
  const all = marks.map((mark, index) => ({
    id: `mark-${index}`,
    x: mark.time_s - zero,
    color: colorOfMark(mark, scheme),
    text: mark.text.length > TEXT_MAX ? `${mark.text.slice(0, TEXT_MAX - 1)}…` : mark.text,
    important: mark.kind === "trigger" || mark.kind === "note" || mark.kind === "gap",
  }));
  return ([from, to]: Window, named: boolean): PlotMark[] => {
    const within = all.filter(({ x }) => x >= from && x <= to);
    const few = within.length <= NAMED_MAX;
    const drawn = within.length <= DRAWN_MAX ? within : within.filter(({ important }) => important).slice(0, DRAWN_MAX);
    // Flags that would lie on each other: what matters first, then what comes first.
    const names = new Map<string, number>();
    if (named)
      for (const { id, x } of [...drawn].sort((one, other) => Number(other.important) - Number(one.important)))
        if ([...names.values()].every((other) => Math.abs(other - x) > (to - from) * APART)) names.set(id, x);
    return drawn.map(({ id, x, color, text, important }) => ({
      id,
      x,
      color,
      fixed: true,
      ...(names.has(id) && (few || important) ? { label: text } : {}),
    }));
  };
}
