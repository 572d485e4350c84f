import type { Answer } from "../../lib/ramp/answer";
import type { Design, Mode, Parameter } from "./design";
import type { Raw } from "./registers";

export interface Finding {
  parameter: Parameter;
  /** a hint says that a value is idle; a caution that the chip may not do what is meant */
  level: "hint" | "caution";
  text: string;
}

/** VSTOP below this many units may crawl the last microsteps (data sheets of the TMC5130 and TMC5160, VSTOP). */
const VSTOP_ADVISED = 10;
/** A register of fewer units than this rounds by more than some percent. */
const COARSE = 10;

/** What there is to say of a design, by what its registers will hold. */
export function findingsOn(design: Design, raws: Raw, mode: Mode, answer: Answer | undefined): Finding[] {
  const found: Finding[] = [];
  const say = (parameter: Parameter, level: Finding["level"], text: string) => found.push({ parameter, level, text });
  if (raws.vmax === 0) say("vmax", "caution", "with 0 the motor never moves");
  if (raws.amax === 0) say("amax", "caution", "with 0 the speed never changes");
  if (mode === "velocity") {
    for (const idle of ["a1", "v1", "dmax", "d1"] as const) say(idle, "hint", "no part in velocity mode");
    if (raws.vstart > raws.vmax) say("vstart", "caution", "above VMAX: it starts at VMAX at once");
    return found;
  }
  if (raws.vstop < raws.vstart)
    say("vstop", "caution", "below VSTART: the chip may not come to rest on the target. VSTOP is to be VSTART or more");
  if (raws.vstop === 0) say("vstop", "caution", "never 0 while positioning: the target may not be reached");
  else if (raws.vstop < VSTOP_ADVISED)
    say("vstop", "hint", `below ${VSTOP_ADVISED} units the last microsteps may crawl`);
  if (raws.d1 === 0) say("d1", "caution", "never 0 while positioning, even where V1 is 0");
  if (raws.dmax === 0) say("dmax", "caution", "with 0 it never brakes");
  if (raws.v1 > 0 && raws.a1 === 0) say("a1", "caution", "with 0 V1 is never reached");
  if (raws.vstart > raws.vmax) say("vstart", "caution", "above VMAX, which is to be VSTART or more");
  if (raws.v1 === 0) {
    if (raws.a1 > 0) say("a1", "hint", "no part in it: V1 is 0");
    if (raws.d1 > 0) say("d1", "hint", "no part in it: V1 is 0");
    say("v1", "hint", "0: a trapezoid of AMAX and DMAX");
  } else if (raws.v1 <= raws.vstart) say("v1", "hint", "VSTART is above it: A1 has no part");
  else if (raws.v1 >= raws.vmax) say("v1", "hint", "VMAX is not above it: AMAX and DMAX have no part");
  const peak = answer?.velocity_pps.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  if (peak !== undefined && !answer?.phases.some((phase) => phase.name === "constant velocity")) {
    if (raws.v1 > 0 && raws.v1 < raws.vmax && peak < design.v1)
      say("v1", "hint", "not reached on this way: A1 and D1 alone");
    else say("vmax", "hint", "not reached on this way");
  }
  for (const parameter of ["a1", "amax", "dmax", "d1"] as const) {
    const raw = raws[parameter];
    if (raw > 0 && raw < COARSE && !found.some((finding) => finding.parameter === parameter))
      say(parameter, "hint", `${raw} units: rounded by up to ${Math.round(50 / raw)} %`);
  }
  return found;
}
