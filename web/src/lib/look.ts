import { stored } from "./shared";

export const DENSITIES = ["auto", "dense", "normal", "touch"] as const;
export type Density = (typeof DENSITIES)[number];
export type Clock = "local" | "utc";

export interface Look {
  /** how high rows and controls are; "auto" is normal, and touch where a finger points */
  density: Density;
  /** the zone that times are written in */
  clock: Clock;
}

/** How this browser likes the page, kept there. */
export const look = stored<Look>("localStorage", "stepscope.look", ({ density, clock }) => ({
  density: DENSITIES.find((each) => each === density) ?? "auto",
  clock: clock === "utc" ? "utc" : "local",
}));
