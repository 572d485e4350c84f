import type { Schemas } from "../../../api/client";
import type { PlotData } from "../../../plots/series";
import type { Study } from "../study";
import { type Trials, trialsOf } from "../trials/points";

export type StealthFound = Schemas["StealthFound"];
export type StealthTried = StealthFound["tried"][number];

/** Jolt [full steps] over the switch-over speed, rising: of what was tried, of the setting before, and what is allowed. */
export function joltsOf(found: Pick<StealthFound, "before" | "tried" | "jolt_max_fullsteps">): PlotData {
  const rows = found.tried
    .map((one) => ({ one, old: false }))
    .concat(found.before === null ? [] : [{ one: found.before, old: true }])
    .flatMap(({ one, old }) => (one.on && one.switch_rps !== null ? [{ rps: one.switch_rps, one, old }] : []))
    .sort((one, other) => one.rps - other.rps);
  return [
    rows.map(({ rps }) => rps),
    rows.map(({ one, old }) => (old ? null : one.jolt_fullsteps)),
    rows.map(({ one, old }) => (old ? one.jolt_fullsteps : null)),
    rows.map(() => found.jolt_max_fullsteps),
  ];
}

/** What was seen of each trial: what was tried stands in the order of the trials. */
export function pointsOf(study: Study, { tried }: Pick<StealthFound, "tried">): Trials {
  const percent = (share: number | null | undefined) => (share == null ? null : 100 * share);
  return trialsOf(study, [
    { name: "jolt", unit: "full steps", of: (_, index) => tried[index]?.jolt_fullsteps },
    { name: "off by", unit: "%", of: (_, index) => percent(tried[index]?.added_share) },
    { name: "amplitude", unit: "%", of: (_, index) => percent(tried[index]?.amplitude_share) },
  ]);
}

/** The setting before, the calculated one and the chosen one, as far as they are there, with what they are. */
export function namedOf({ before, calculated, chosen }: StealthFound): [string, StealthTried][] {
  const named: [string, StealthTried | null][] = [
    ["before", before],
    ["calculated", calculated],
    ["best", chosen],
  ];
  return named.flatMap(([name, one]) => (one === null ? [] : [[name, one] as [string, StealthTried]]));
}

/** Up to which speed StealthChop works by a setting, for people. */
export function reachOf({ on, switch_rps }: StealthTried, digits: (value: number) => string): string {
  if (!on) return "never";
  return switch_rps === null ? "every speed" : `${digits(switch_rps)} turns/s`;
}
