import type { Device } from "../../api/queries";
import { can } from "../../api/queries";

export type StepId = "motor" | "limits" | "setUp" | "turn" | "encoder" | "switches" | "move" | "keep";

export interface StepEntry {
  id: StepId;
  title: string;
  /** what it does to the machine */
  does: string;
}

const STILL = "Nothing moves.";
const ALL: readonly (StepEntry & { fits?: (device: Device) => boolean })[] = [
  { id: "motor", title: "Motor", does: STILL },
  { id: "limits", title: "Limits", does: STILL },
  {
    id: "setUp",
    title: "Current and ramp",
    does: `${STILL} Coils get their current: the motor holds, and may jerk by a step.`,
  },
  { id: "turn", title: "Direction", does: "The motor turns, there and back." },
  {
    id: "encoder",
    title: "Encoder",
    does: "The motor turns a few times, there and back.",
    fits: (device) => can(device, "encoder") && !can(device, "parameters"),
  },
  { id: "switches", title: "Switches and zero", does: "A search moves slowly to a switch." },
  { id: "move", title: "First move", does: "The motor moves one turn, and back." },
  { id: "keep", title: "Keep it", does: STILL },
];

/** The steps that make sense for a device, in their order. */
export function stepsFor(device: Device): readonly StepEntry[] {
  return ALL.filter(({ fits }) => fits?.(device) ?? true);
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
}

export const BEGIN: Progress = { at: "motor", done: [], motor: null };

/** The step behind `id`, or `id` where it is the last. */
export function after(steps: readonly StepEntry[], id: StepId): StepId {
  const place = steps.findIndex((step) => step.id === id);
  return steps[place + 1]?.id ?? id;
}

export function before(steps: readonly StepEntry[], id: StepId): StepId {
  const place = steps.findIndex((step) => step.id === id);
  return steps[place - 1]?.id ?? id;
}

/** Done, and on to the next. */
export function done(progress: Progress, steps: readonly StepEntry[], id: StepId): Progress {
  return {
    ...progress,
    at: after(steps, id),
    done: progress.done.includes(id) ? progress.done : [...progress.done, id],
  };
}
