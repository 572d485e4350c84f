import type { Schemas } from "../../../api/client";
import type { PlotData } from "../../../plots/series";

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
