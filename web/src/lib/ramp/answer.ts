import type { Schemas } from "../../api/client";

/** What POST /calc/ramp says of a design. */
export type Answer = Schemas["RampResult"];
export type Rival = Answer["rivals"][number];

/** What a ramp is plotted as, each on a plot of its own. */
export type Kind = "position" | "velocity" | "acceleration" | "jerk";
