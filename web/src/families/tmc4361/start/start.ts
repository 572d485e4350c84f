import type { ChipRows } from "../../../lib/rows/useChipRows";

type Planned = Pick<ChipRows, "planned">;

/** What may give a start, in the order of trigger_events. */
export const TRIGGERS = ["START pin", "TARGET_REACHED", "VEL_REACHED", "POS_COMP_REACHED"] as const;
/** What a start does, in the order of start_en. */
export const WAITING = ["new XTARGET", "new VMAX", "new RAMPMODE", "new GEAR_RATIO", "shadow registers"] as const;
export const PIPED = ["XTARGET", "POS_COMP", "GEAR_RATIO", "GENERAL_CONF"] as const;

export interface Start {
  triggers: boolean[];
  waiting: boolean[];
  piped: boolean[];
  /** the pin is an input as soon as it is a trigger */
  pin: "input" | "output";
  activeHigh: boolean;
  /** of triggers but the pin [s] */
  delayS: number;
  /** of the pin [s] */
  pinDelayS: number;
  /** of the pulse at START as an output [s] */
  pulseS: number;
  busy: boolean;
  findings: string[];
}

/** What triggers what, with what is staged; null until all of it is known. */
export function startOf(chip: Planned, clockHz: number): Start | null {
  const bits = (name: string, count: number) =>
    Array.from({ length: count }, (_, n) => chip.planned("START_CONF", `${name}[${n}]`));
  const known = [...bits("trigger_events", 4), ...bits("start_en", 5), ...bits("pipeline_en", 4)];
  const [delay, pulse] = [chip.planned("START_DELAY"), chip.planned("START_OUT_ADD")];
  const [high, immediate, busyState] = ["pol_start_signal", "immediate_start_in", "busy_state_en"].map((field) =>
    chip.planned("START_CONF", field),
  );
  if (known.includes(null) || delay === null || pulse === null || high === null || high === undefined) return null;
  const set = known.map((value) => value === 1);
  const [triggers, waiting, piped] = [set.slice(0, 4), set.slice(4, 9), set.slice(9)];
  const byPin = triggers[0] === true;
  const any = triggers.includes(true);
  const findings: string[] = [];
  if (!any && (waiting.includes(true) || piped.includes(true)))
    findings.push("Nothing gives a start: what waits for one waits for ever.");
  if (any && !waiting.includes(true) && !piped.includes(true))
    findings.push("Starts do nothing here: no register waits for one, and no pipeline moves.");
  if (busyState === 1 && !byPin) findings.push("busy_state_en takes the pin as an input too, once a start is due.");
  if (byPin && immediate === 1 && delay > 0) findings.push("START_DELAY counts for the other triggers alone.");
  return {
    triggers,
    waiting,
    piped,
    pin: byPin ? "input" : "output",
    activeHigh: high === 1,
    delayS: delay / clockHz,
    pinDelayS: immediate === 1 ? 0 : delay / clockHz,
    pulseS: (pulse + 1) / clockHz,
    busy: busyState === 1,
    findings,
  };
}

export type StepMode = 0 | 1 | 2 | 3;

export interface StepInput {
  mode: StepMode;
  /** steps of the chip a step that comes in */
  ratio: number;
  /** the ramp follows the target that the steps move */
  indirect: boolean;
}

/** GEAR_RATIO: 8 bits, then 24 of fraction, signed (NOTES-TMC4361-RAMPS 7). */
export const GEAR_ONE = 2 ** 24;

export function stepInputOf(chip: Planned): StepInput | null {
  const mode = chip.planned("GENERAL_CONF", "sdin_mode");
  const gear = chip.planned("GEAR_RATIO");
  const indirect = chip.planned("GENERAL_CONF", "sd_indirect_control");
  if (mode === null || gear === null || indirect === null) return null;
  return { mode: (mode & 3) as StepMode, ratio: gear / GEAR_ONE, indirect: indirect === 1 };
}

export interface StepsOut {
  /** edges that count */
  counted: number;
  /** whole steps that come out, from an accumulator that begins at 0 */
  steps: number;
  pps: number;
}

/** What pulses (signed by DIRIN) at a rate come to. Each adds GEAR_RATIO to an accumulator; its whole part are steps. */
export function stepsOut({ mode, ratio }: StepInput, pulses: number, rateHz: number): StepsOut {
  const edges = mode === 0 ? 0 : mode === 3 ? 2 : 1;
  const counted = pulses * edges;
  const word = BigInt(Math.round(ratio * GEAR_ONE));
  // exact: the accumulator has the same 24 bits behind the point
  const steps = Number((BigInt(counted) * word) >> 24n);
  return { counted, steps, pps: rateHz * edges * ratio * Math.sign(pulses) };
}

/** What is wrong with steps from outside, in words. */
export function stepFindings(input: StepInput, pps: number, clockHz: number): string[] {
  const found: string[] = [];
  if (input.mode === 0) found.push("sdin_mode is off: steps at STPIN do nothing.");
  else if (input.ratio === 0) found.push("GEAR_RATIO is 0: no step comes out.");
  if (Math.abs(pps) > clockHz / 2) found.push("Faster than half of the clock: steps get lost.");
  if (input.mode !== 0 && !input.indirect)
    found.push("Steps have control: no ramp, no target, and moves from here do nothing until sdin_mode is off.");
  return found;
}
