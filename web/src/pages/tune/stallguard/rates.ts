import type { Schemas } from "../../../api/client";
import { compact } from "../../../lib/format";
import type { PlotData } from "../../../plots/series";
import type { Study } from "../study";
import { type Trials, trialsOf } from "../trials/points";

export type StallFound = Schemas["StallFound"];
export type StallSpeed = StallFound["speeds"][number];
type Rate = Schemas["Rate"];

/** "0 of 100: below 3 %", or that nothing was tried. */
export function rateText(rate: Rate | null): string {
  return rate === null ? "not tried" : `${rate.wrong} of ${rate.runs}: below ${compact(100 * rate.most, 2, "%")}`;
}

/** "-8", "3 with the filter, its own": what is proved at a speed; nothing where nothing is. */
export function thresholdText({ own, why }: StallSpeed, { trials, best }: Study): string {
  const chosen = trials.find(({ number }) => number === best)?.setting;
  if (own === null && (why !== "" || !chosen)) return "";
  const threshold = own?.threshold ?? chosen?.threshold;
  const filtered = own?.filtered ?? chosen?.filter === 1;
  return `${threshold}${filtered ? " with the filter" : ""}${own ? ", its own" : ""}`;
}

/** "-8 with the filter: 0 of 100 false, 0 of 20 missed", counted in the runs by which it was chosen. */
export function aloneText(alone: StallSpeed["alone"]): string {
  if (alone === null) return "";
  const { threshold, filtered, false: wrong, free_runs, missed, stops, may_do } = alone;
  const rates = `${wrong} of ${free_runs} false, ${missed} of ${stops} missed`;
  return `${threshold}${filtered ? " with the filter" : ""}: ${rates}${may_do ? "" : ", too many"}`;
}

/** Shares over load values: of free runs, and against the stop. */
export function distributionsOf(speed: StallSpeed): PlotData {
  const middles = speed.values.slice(1).map((edge, index) => (edge + (speed.values[index] ?? edge)) / 2);
  return [middles, speed.free_share, speed.stop_share];
}

/** Missed stalls over false ones, from the level that tells none to the one that tells all. */
export function rocOf(speed: StallSpeed): PlotData {
  const points = [[0, 1], ...speed.roc.map(({ false: wrong, missed }) => [wrong, missed]), [1, 0]];
  return [points.map(([wrong]) => wrong ?? 0), points.map(([, missed]) => missed ?? 0)];
}

/** Choices that were tried on held-out runs, with the runs that it took to refute or prove them. */
export function pointsOf(study: Study): Trials {
  const runs = trialsOf(study, [{ name: "held-out runs", unit: "", of: ({ figures }) => figures.runs }]);
  return { ...runs, lost: "too many stalls false or missed" };
}
