import type { Band } from "../../plots/usePlotBands";
import type { Answer } from "./answer";

export type Scheme = "light" | "dark";

/** The colours of phases by name: what changes speed is warm on the way up and cool on the way down. */
export type Hues = Readonly<Record<string, readonly [light: string, dark: string]>>;

/** A phase that speeds up, one that goes on at one speed, one that brakes; the light shades are of softer ones. */
export const WARM = ["#a86400", "#ffc14d"] as const;
export const WARM_SOFT = ["#e69f00", "#e69f00"] as const;
export const PLAIN = ["#8a8f98", "#8a8f98"] as const;
export const COOL = ["#0068a8", "#3a9be0"] as const;
export const COOL_SOFT = ["#4b2fa3", "#8f7bff"] as const;

export function hueOf(phase: string, hues: Hues, scheme: Scheme): string {
  return (hues[phase] ?? PLAIN)[scheme === "light" ? 0 : 1];
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
 * Every phase of `order`, with those that take no time at the moment where they would be. What a motion from any state
 * does besides (braking first, coming back) follows as it comes.
 */
export function stretchesIn(phases: Answer["phases"], order: readonly string[]): Stretch[] {
  const present = phases.filter((phase) => phase.end_s > phase.start_s);
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

export function phaseBands(phases: readonly Stretch[], hues: Hues, scheme: Scheme, named: boolean): Band[] {
  return phases
    .filter((phase) => !phase.empty)
    .map((phase) => ({
      from: phase.startS,
      to: phase.endS,
      color: faded(hueOf(phase.name, hues, scheme), scheme === "light" ? 0.17 : 0.2),
      ...(named ? { label: phase.name, labelColor: scheme === "light" ? "#374151" : "#d3d8de" } : {}),
    }));
}
