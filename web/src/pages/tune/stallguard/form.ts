import type { KindForm } from "../kind";

export interface StallGuardForm {
  side: "left" | "right";
  withinFullsteps: number;
  /** a hard stop is there that may be run into */
  confirmed: boolean;
  /** [turns of the motor a second], as typed */
  speeds: string;
  freeRuns: number;
  stops: number;
  /** prove a threshold of its own at a speed at which that of the others does not do it */
  eachSpeed: boolean;
}

/** Speeds as typed, rising and each once: "0.5, 1 2" is 0.5, 1, 2. */
export function speedsOf(text: string): number[] {
  const typed = text
    .split(/[\s,;]+/)
    .map(Number)
    .filter((speed) => Number.isFinite(speed) && speed > 0);
  return [...new Set(typed)].sort((one, other) => one - other);
}

export const STALLGUARD: KindForm<StallGuardForm> = {
  label: "Sure of its stops",
  text: "The StallGuard threshold that tells a stop from a free run, with how often either is told wrong.",
  title: "StallGuard threshold",
  first: () => ({
    side: "left",
    withinFullsteps: 2000,
    confirmed: false,
    speeds: "0.5, 1, 2",
    freeRuns: 100,
    stops: 20,
    eachSpeed: true,
  }),
  wish: (form) => ({
    study: {
      kind: "stallguard",
      side: form.side,
      within_fullsteps: form.withinFullsteps,
      stop_confirmed: form.confirmed,
      speeds_rps: speedsOf(form.speeds),
      free_runs: form.freeRuns,
      stops: form.stops,
      each_speed: form.eachSpeed,
    },
    budget: { time_s: 86_400 },
  }),
};
