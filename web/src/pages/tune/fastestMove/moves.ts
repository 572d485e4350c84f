import type { PlotData } from "../../../plots/series";
import type { Study } from "../study";

export type Move = Study["moves"][number];

const POINTS = 160;

/** Where the encoder was at `time` of a move; null before its first sample and behind its last. */
export function at({ time_s: times, fullsteps }: Move, time: number): number | null {
  const after = times.findIndex((each) => each >= time);
  if (after < 0) return null;
  const there = times[after] ?? time;
  if (there === time) return fullsteps[after] ?? null;
  if (after === 0) return null;
  const here = times[after - 1] ?? there;
  const share = (time - here) / (there - here);
  return (fullsteps[after - 1] ?? 0) * (1 - share) + (fullsteps[after] ?? 0) * share;
}

/** When the encoder was last further than a hundredth of the way from where it ended [s]. */
function arrivedAt({ time_s: times, fullsteps }: Move): number {
  const last = fullsteps.at(-1) ?? 0;
  const far = fullsteps.findLastIndex((value) => Math.abs(value - last) > Math.abs(last) / 100);
  return times[Math.max(far, 0)] ?? 0;
}

/** Moves over one time [full steps over s], in the order of `wanted`, until the slowest has arrived; null where one is not there. */
export function movesOf(moves: readonly Move[], wanted: readonly Move["which"][]): PlotData {
  const end = 1.15 * Math.max(0, ...moves.map(arrivedAt));
  const times = Array.from({ length: POINTS + 1 }, (_, index) => (end * index) / POINTS);
  const column = (which: Move["which"]) => {
    const move = moves.find((each) => each.which === which);
    return times.map((time) => (move ? at(move, time) : null));
  };
  return [times, ...wanted.map(column)];
}

/** One of several distances, by its place in their order where it is there twice, with its times before and best [s]. */
export interface DistanceTimes {
  name: string;
  before: number | null;
  best: number | null;
}

/** What each of several distances takes; none of one alone. */
export function timesOf({ document, baseline_figures: baseline, trials, best }: Study): DistanceTimes[] {
  const asked = document.study;
  if (asked.kind !== "fastest_move" || !baseline?.by_distance_s.length) return [];
  const found = trials.find(({ number }) => number === best)?.figures.by_distance_s;
  const every = [asked.distance, ...(asked.distances ?? [])];
  return every.map((distance, index) => ({
    name: every.indexOf(distance) === index ? `${distance}` : `${distance} (${index + 1})`,
    before: baseline.by_distance_s[index] ?? null,
    best: found?.[index] ?? null,
  }));
}
