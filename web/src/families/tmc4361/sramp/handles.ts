import { type Handle, handlesIn, type Layout } from "../../../lib/ramp/handles";
import type { Stretch } from "../../../lib/ramp/phases";
import { type Design, KIND, MEANING, type Options, type Parameter } from "./design";

const LAYOUT: Layout<Parameter> = {
  places: {
    vmax: { on: ["B23", "A2", "HOLD", "B2"], at: "beside" },
    amax: { on: ["B12", "A1", "B2"], at: "middle" },
    dmax: { on: ["B34", "A3", "B4"], at: "middle", brakes: true },
    bow1: { on: ["B1"], at: "middle" },
    bow2: { on: ["B2"], at: "middle", brakes: true },
    bow3: { on: ["B3"], at: "middle", brakes: true },
    bow4: { on: ["B4"], at: "middle" },
    vstart: { on: [], at: "start", whole: true },
    vstop: { on: [], at: "end", whole: true },
    astart: { on: [], at: "start", whole: true },
    dfinal: { on: [], at: "end", whole: true, brakes: true },
    vbreak: { on: ["A1L"], at: "end", aside: true },
  },
  kinds: KIND,
  meanings: MEANING,
};

/** Which parameters are on the plots: those of the ramp, but DFINAL where it is ignored (positioning, DS-TMC4361 8.2.1). */
export function shownHandles(parameters: readonly Parameter[], options: Options): Parameter[] {
  return parameters.filter((parameter) => parameter !== "dfinal" || options.mode === "velocity");
}

/** Where the handles of an S-ramp stand. */
export function handlesOf(
  design: Design,
  parameters: readonly Parameter[],
  phases: readonly Stretch[],
  durationS: number,
  way: 1 | -1,
): Handle<Parameter>[] {
  return handlesIn(LAYOUT, design, parameters, phases, durationS, way);
}
