import type { Schemas } from "../../api/client";

export type Side = "left" | "right" | "home";
export type Switches = Schemas["MotionSwitches"];

export type Answer =
  | { kind: "waiting" }
  | { kind: "right one" }
  /** another input has answered */
  | { kind: "other"; side: Side }
  /** it was active before it was pressed */
  | { kind: "active already" }
  | { kind: "none" };

const SIDES: readonly Side[] = ["left", "right", "home"];

/** What came of pressing `side`: the switches before, the switches now, and whether its time is over. */
export function answerTo(side: Side, before: Switches, now: Switches, over: boolean): Answer {
  const changed = SIDES.filter((each) => before[each] !== null && now[each] !== null && before[each] !== now[each]);
  if (changed.includes(side)) return { kind: before[side] ? "active already" : "right one" };
  const [other] = changed;
  if (other !== undefined) return { kind: "other", side: other };
  return { kind: over ? "none" : "waiting" };
}
