import { stored } from "./shared";

export const DENSITIES = ["auto", "dense", "normal", "touch"] as const;
export type Density = (typeof DENSITIES)[number];
export type Clock = "local" | "utc";

export interface Look {
  /** how high rows and controls are; "auto" is dense, and touch where a finger points */
  density: Density;
  /** the zone that times are written in */
  clock: Clock;
}

/** How this browser likes the page, kept there. */
export const look = stored<Look>("localStorage", "stepscope.look", ({ density, clock }) => ({
  density: DENSITIES.find((each) => each === density) ?? "auto",
  clock: clock === "utc" ? "utc" : "local",
}));

/** Tells the style sheets how dense the page is, now and whenever that changes. */
export function followDensity(root: HTMLElement): void {
  const finger = window.matchMedia("(pointer: coarse)");
  const tell = () => {
    const { density } = look.get();
    root.dataset.density = density === "auto" ? (finger.matches ? "touch" : "dense") : density;
  };
  finger.addEventListener("change", tell);
  look.subscribe(tell);
  tell();
}
