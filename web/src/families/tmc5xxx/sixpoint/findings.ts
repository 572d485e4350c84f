import type { Answer } from "../../../lib/ramp/answer";
import type { Mode } from "../../../lib/ramp/DesignPlots";
import type { Design, Parameter } from "./design";
import type { Raw } from "./registers";

export interface Finding {
  parameter: Parameter;
  /** a hint says that a value is idle or rounded; a caution that the chip may not do what is meant */
  level: "hint" | "caution";
  text: string;
}

/** What the calculator calls a parameter, where the page has another name for it. */
const NAMES: Readonly<Record<string, Parameter>> = { t_zero_wait_s: "tzerowait" };
/** A register of fewer units than this rounds by more than some percent. */
const COARSE = 10;

/**
 * What there is to say of a design: what the calculator warns of, and which values have no part in this ramp. `answer`
 * is that of the design; undefined while there is none.
 */
export function findingsOn(design: Design, raws: Raw, mode: Mode, answer: Answer | undefined): Finding[] {
  const found: Finding[] = (answer?.findings ?? []).flatMap(({ parameter, text }) =>
    parameter === null
      ? []
      : [{ parameter: NAMES[parameter] ?? (parameter as Parameter), level: "caution" as const, text }],
  );
  const told = (parameter: Parameter) => found.some((finding) => finding.parameter === parameter);
  const say = (parameter: Parameter, text: string) => found.push({ parameter, level: "hint", text });
  if (mode === "velocity") {
    for (const idle of ["a1", "v1", "dmax", "d1"] as const) say(idle, "no part in velocity mode");
    return found;
  }
  if (raws.v1 === 0) {
    if (raws.a1 > 0) say("a1", "no part in it: V1 is 0");
    if (raws.d1 > 0) say("d1", "no part in it: V1 is 0");
    if (!told("v1")) say("v1", "0: a trapezoid of AMAX and DMAX");
  } else if (raws.v1 <= raws.vstart) say("v1", "VSTART is above it: A1 has no part");
  const peak = answer?.velocity_pps.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  if (peak !== undefined && !answer?.phases.some((phase) => phase.name === "constant velocity")) {
    if (raws.v1 > 0 && raws.v1 < raws.vmax && peak < design.v1) say("v1", "not reached on this way: A1 and D1 alone");
    else say("vmax", "not reached on this way");
  }
  for (const parameter of ["a1", "amax", "dmax", "d1"] as const) {
    const raw = raws[parameter];
    if (raw > 0 && raw < COARSE && !told(parameter))
      say(parameter, `${raw} units: rounded by up to ${Math.round(50 / raw)} %`);
  }
  return found;
}
