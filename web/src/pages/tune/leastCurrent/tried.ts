import type { Schemas } from "../../../api/client";
import type { PlotData } from "../../../plots/series";
import type { Trials } from "../trials/points";

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

export const FIELDS = ["semin", "semax", "seup", "sedn", "seimin"] as const;

export function isSame(one: CoolSetting, other: CoolSetting): boolean {
  return FIELDS.every((field) => one[field] === other[field]);
}

/** Settings of CoolStep and the heat that each leaves, in the order of the trials. */
export function coolPointsOf({ tried, setting }: Pick<CoolStepFound, "tried" | "setting">): Trials {
  const best = tried.findLastIndex((one) => one.held && setting !== null && isSame(one.setting, setting));
  return {
    settings: FIELDS.map((field) => ({ name: field.toUpperCase(), unit: "" })),
    figures: [{ name: "heat left", unit: "%" }],
    points: tried.map((one, index) => ({
      number: index + 1,
      state: one.held ? "held" : "lost",
      values: [...FIELDS.map((field) => one.setting[field]), one.heat_share === null ? null : 100 * one.heat_share],
    })),
    best: best < 0 ? null : best + 1,
    lost: "lost steps",
  };
}
