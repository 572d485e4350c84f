import type { Schemas } from "../../../api/client";
import type { PlotData } from "../../../plots/series";
import type { Study } from "../study";
import { type Trials, trialsOf } from "../trials/points";

export type ChopperFound = Schemas["ChopperFound"];
export type ChopperTried = ChopperFound["tried"][number];

/** Ripple [full steps] over hysteresis, rising: of what was tried, and of the setting before. */
export function rippleOf({ before, tried }: Pick<ChopperFound, "before" | "tried">): PlotData {
  const rows = tried
    .map((one) => ({ one, old: false }))
    .concat(before === null ? [] : [{ one: before, old: true }])
    .sort((one, other) => one.one.hysteresis - other.one.hysteresis);
  return [
    rows.map(({ one }) => one.hysteresis),
    rows.map(({ one, old }) => (old ? null : one.ripple_fullsteps)),
    rows.map(({ one, old }) => (old ? one.ripple_fullsteps : null)),
  ];
}

/** Ripple and chopper frequency of each trial: what was tried stands in the order of the trials. */
export function pointsOf(study: Study, { tried }: Pick<ChopperFound, "tried">): Trials {
  return trialsOf(study, [
    { name: "ripple", unit: "full steps", of: (_, index) => tried[index]?.ripple_fullsteps },
    { name: "chopper, about", unit: "Hz", of: (_, index) => tried[index]?.chopper_hz },
  ]);
}

/** The setting before, the calculated one and the chosen one, as far as they are there, with what they are. */
export function namedOf({ before, calculated, chosen }: ChopperFound): [string, ChopperTried][] {
  const named: [string, ChopperTried | null][] = [
    ["before", before],
    ["calculated", calculated],
    ["best", chosen],
  ];
  return named.flatMap(([name, one]) => (one === null ? [] : [[name, one] as [string, ChopperTried]]));
}
