import type { Answer, Shape } from "./design";

export type Scheme = "light" | "dark";

/** The phases of a slope up, a cruise and a slope down, in their order (002, 8.2 and 8.1.2). */
export const PHASES: Record<Shape, readonly string[]> = {
  s: ["B1", "B12", "B2", "B23", "B3", "B34", "B4"],
  trapezoid: ["A1L", "A1", "A2", "A3", "A3L"],
  hold: ["HOLD"],
};

/** What changes speed is warm on the way up and cool on the way down; bows are the light shades of each. */
const HUES: Record<string, readonly [light: string, dark: string]> = {
  B1: ["#e69f00", "#e69f00"],
  B12: ["#b87400", "#ffc14d"],
  B2: ["#d6bd1a", "#e8db4a"],
  B23: ["#8a8f98", "#8a8f98"],
  B3: ["#56b4e9", "#56b4e9"],
  B34: ["#0072b2", "#3a9be0"],
  B4: ["#6b4fbb", "#a08bf0"],
  A1L: ["#e69f00", "#e69f00"],
  A1: ["#b87400", "#ffc14d"],
  A2: ["#8a8f98", "#8a8f98"],
  A3: ["#0072b2", "#3a9be0"],
  A3L: ["#6b4fbb", "#a08bf0"],
};

export function hueOf(phase: string, scheme: Scheme): string {
  return (HUES[phase] ?? ["#8a8f98", "#8a8f98"])[scheme === "light" ? 0 : 1];
}

/** `#rrggbb` with an opacity. */
export function faded(color: string, opacity: number): string {
  const part = (at: number) => Number.parseInt(color.slice(at, at + 2), 16);
  return `rgba(${part(1)}, ${part(3)}, ${part(5)}, ${opacity})`;
}

export interface Stretch {
  name: string;
  startS: number;
  endS: number;
  /** it takes no time: its limit is not reached, or VSTART and VSTOP skip it */
  empty: boolean;
}

/**
 * Every phase of the shape in its order, with those that take no time at the moment where they would be. What a motion
 * from any state does besides (braking first, coming back) follows as it comes.
 */
export function stretches(phases: Answer["phases"], shape: Shape): Stretch[] {
  const present = phases.filter((phase) => phase.end_s > phase.start_s);
  const order = PHASES[shape];
  const plain = present.every((phase, at) => {
    const before = present[at - 1];
    return order.includes(phase.name) && (!before || order.indexOf(before.name) < order.indexOf(phase.name));
  });
  const asStretch = (phase: Answer["phases"][number]): Stretch => ({
    name: phase.name,
    startS: phase.start_s,
    endS: phase.end_s,
    empty: false,
  });
  if (!plain) return present.map(asStretch);
  let at = present[0]?.start_s ?? 0;
  return order.map((name) => {
    const found = present.find((phase) => phase.name === name);
    if (!found) return { name, startS: at, endS: at, empty: true };
    at = found.end_s;
    return asStretch(found);
  });
}
