import { rounded } from "../format";
import type { Kind } from "./answer";
import type { Stretch } from "./phases";

/** Something to take hold of on a plot: a limit or a bow, at the height of its value. */
export interface Handle<P extends string = string> {
  parameter: P;
  /** what it is, in words */
  meaning: string;
  /** on which plot */
  track: Kind;
  /** where along the motion [s] */
  timeS: number;
  /** what the plot's y is there, for a value of 1: -1 where it brakes, or goes the other way */
  sign: 1 | -1;
  /** [pps, pps², pps³], not negative */
  value: number;
  /** it has no effect on this ramp: its phase takes no time */
  idle: boolean;
}

/** Where the handle of a parameter stands. */
export interface Place {
  /** the phases that it stands on, the first one that there is */
  on: readonly string[];
  at: "start" | "middle" | "beside" | "end";
  /** where it has no phase it stands a little aside */
  aside?: true;
  brakes?: true;
  /** of the whole motion, not of a phase */
  whole?: true;
}

/** What a page says of its parameters. */
export interface Layout<P extends string> {
  places: Readonly<Record<P, Place>>;
  kinds: Readonly<Record<P, Kind>>;
  meanings: Readonly<Record<P, string>>;
}

/**
 * Where the handles stand for a motion that is `durationS` long and goes the way of `way`. Those of phases that take
 * no time stay where their phase would be, at their value: they can be dragged until they count again.
 */
export function handlesIn<P extends string>(
  layout: Layout<P>,
  design: Readonly<Record<P, number>>,
  parameters: readonly P[],
  phases: readonly Stretch[],
  durationS: number,
  way: 1 | -1,
): Handle<P>[] {
  return parameters.map((parameter) => {
    const place: Place = layout.places[parameter];
    const named = place.on
      .map((name) => phases.find((phase) => phase.name === name))
      .filter((phase) => phase !== undefined);
    const stretch = named.find((phase) => !phase.empty) ?? named[0];
    const first = named[0];
    return {
      parameter,
      meaning: layout.meanings[parameter],
      track: layout.kinds[parameter],
      timeS: timeOf(place, stretch, first, durationS),
      sign: (place.brakes ? -way : way) as 1 | -1,
      value: design[parameter],
      idle: idle(place, design[parameter], first),
    };
  });
}

function timeOf(place: Place, stretch: Stretch | undefined, first: Stretch | undefined, durationS: number): number {
  if (place.whole || !stretch) return place.at === "start" ? 0 : place.at === "end" ? durationS : durationS / 2;
  // VBREAK and VSTART would lie on each other
  if (first?.empty && place.aside) return durationS * 0.08;
  // the phase itself takes no time: the moment where it would be
  if (first?.empty) return first.startS;
  if (place.at === "end") return stretch.endS;
  // in the middle of a phase stands its name, at the height of VMAX
  const share = place.at === "start" ? 0 : place.at === "beside" ? 0.72 : 0.5;
  return stretch.startS + share * (stretch.endS - stretch.startS);
}

function idle(place: Place, value: number, first: Stretch | undefined): boolean {
  return place.whole ? value === 0 : first === undefined || first.empty;
}

/** What a value becomes when its handle goes from one y to another by pointer; `perPx` is y a pixel, as it was first. */
export function dragged(from: number, sign: 1 | -1, upPx: number, perPx: number, step: number): number {
  const wanted = from + sign * upPx * perPx;
  return wanted <= 0 ? 0 : tidy(wanted, Math.abs(perPx), step);
}

/** The roundest value within a pixel of `value`, on the register's grid. */
export function tidy(value: number, perPx: number, step: number): number {
  const power = 10 ** Math.floor(Math.log10(Math.max(perPx, 1e-9)));
  const round = Math.max(power, step);
  return rounded(Math.round(value / round) * round, 12);
}

/** Keys: arrows a hundredth, with Shift or Page keys a tenth; Home the least, End the most. null: not ours. */
export function stepped(
  key: string,
  shift: boolean,
  value: number,
  sign: 1 | -1,
  limits: { least: number; most: number; step: number },
): number | null {
  const { least, most, step } = limits;
  const by = (share: number) => {
    const start = value > 0 ? value : step * 100;
    const change = Math.max(start * Math.abs(share), step) * Math.sign(share);
    // a value that has gone down to nothing comes back from nothing
    const next = value > 0 ? value + change : share > 0 ? start : 0;
    return Math.min(most, Math.max(least, rounded(next, 4) < step ? least : rounded(next, 4)));
  };
  const share = shift ? 0.1 : 0.01;
  switch (key) {
    case "ArrowUp":
      return by(sign * share);
    case "ArrowDown":
      return by(-sign * share);
    case "ArrowRight":
      return by(share);
    case "ArrowLeft":
      return by(-share);
    case "PageUp":
      return by(0.1);
    case "PageDown":
      return by(-0.1);
    case "Home":
      return least;
    case "End":
      return most;
    default:
      return null;
  }
}
