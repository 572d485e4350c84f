import type { Device } from "../../api/queries";
import { can } from "../../api/queries";
import type { FurtherFigures } from "../../lib/motors/figures";

export type StepId = "link" | "motor" | "limits" | "setUp" | "turn" | "encoder" | "switches" | "move" | "keep";

export interface StepEntry {
  id: StepId;
  title: string;
  /** what it does to the machine */
  does: string;
}

const STILL = "Nothing moves.";

/** The steps, in their order. A device that lacks what one is about is told so there, and how to go on. */
export const STEPS: readonly StepEntry[] = [
  { id: "link", title: "Wire", does: STILL },
  { id: "motor", title: "Motor", does: STILL },
  {
    id: "setUp",
    title: "Current and ramp",
    does: `${STILL} Coils get their current: the motor holds, and may jerk by a step.`,
  },
  // Behind what sets the microsteps that limits are counted in.
  { id: "limits", title: "Limits", does: STILL },
  { id: "turn", title: "Direction", does: "The motor turns, there and back." },
  { id: "encoder", title: "Encoder", does: "The motor turns a few times, there and back." },
  { id: "switches", title: "Switches and zero", does: "A search moves slowly to a switch." },
  { id: "move", title: "First move", does: "The motor moves one turn, and back." },
  { id: "keep", title: "Keep it", does: STILL },
];

/** By what a device turns its motor: to a position, at a velocity of its own, or only as it is stepped from outside. */
export type TurnsBy = "position" | "velocity" | "steps from outside";

export function turnsBy(device: Pick<Device, "about">): TurnsBy {
  if (!can(device, "step_input")) return "position";
  return can(device, "own_velocity") ? "velocity" : "steps from outside";
}

/** Who looks at the encoder: a study, the condition of the axis, or nobody. */
export type EncoderLook = "study" | "condition" | "none";

export function encoderLook(device: Pick<Device, "about">): EncoderLook {
  if (!can(device, "encoder")) return "none";
  // that of a module is built in: nobody has to say how many lines it has
  return can(device, "parameters") ? "condition" : "study";
}

/** What was entered and done, kept until the tab is closed. */
export interface Progress {
  at: StepId;
  done: readonly StepId[];
  motor: ChosenMotor | null;
}

export interface ChosenMotor {
  name: string;
  ratedCurrentA: number;
  fullStepsPerRev: number;
  /** what makes amperes of current scales; null where the device knows by itself, or nobody does */
  senseResistorOhm: number | null;
  fullScaleA: number | null;
  /** what else is known of it, to be kept with it */
  further?: FurtherFigures;
}

export const BEGIN: Progress = { at: "link", done: [], motor: null };

/** Under which name the browser keeps it. */
export function progressKey(device: string, axis: number): string {
  return `stepscope.first-run.${device}.${axis}`;
}

/** The step behind `id`, or `id` where it is the last. */
export function after(id: StepId): StepId {
  return beside(id, 1);
}

export function before(id: StepId): StepId {
  return beside(id, -1);
}

function beside(id: StepId, by: number): StepId {
  return STEPS[STEPS.findIndex((step) => step.id === id) + by]?.id ?? id;
}

/** Done, and on to the next. */
export function done(progress: Progress, id: StepId): Progress {
  return {
    ...progress,
    at: after(id),
    done: progress.done.includes(id) ? progress.done : [...progress.done, id],
  };
}
