import type { Schemas } from "../../../api/client";
import type { PlotData } from "../../../plots/series";

export type LeastCurrentFound = Schemas["LeastCurrentFound"];
export type CoolStepFound = Schemas["CoolStepFound"];
export type CoolSetting = Schemas["CoolSetting"];

/** Peak deviation over the run current [1/32], rising: where no step was lost, and where some were. */
export function triedOf({ tried }: Pick<LeastCurrentFound, "tried">): PlotData {
  const rows = [...tried].sort((one, other) => one.scale - other.scale);
  return [
    rows.map(({ scale }) => scale + 1),
    rows.map(({ held, deviation_fullsteps: deviation }) => (held ? deviation : null)),
    rows.map(({ held, deviation_fullsteps: deviation }) => (held ? null : deviation)),
  ];
}
