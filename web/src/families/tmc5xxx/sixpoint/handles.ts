import type { Mode } from "../../../lib/ramp/DesignPlots";
import { type Handle, handlesIn, type Layout } from "../../../lib/ramp/handles";
import type { Stretch } from "../../../lib/ramp/phases";
import { type Design, type Drawn, KIND, MEANING, used } from "./design";

const LAYOUT: Layout<Drawn> = {
  places: {
    vstart: { on: [], at: "start", whole: true },
    a1: { on: ["A1"], at: "middle" },
    v1: { on: ["A1"], at: "end", aside: true },
    amax: { on: ["AMAX"], at: "middle" },
    vmax: { on: ["VMAX"], at: "beside" },
    dmax: { on: ["DMAX"], at: "middle", brakes: true },
    d1: { on: ["D1"], at: "middle", brakes: true },
    vstop: { on: [], at: "end", whole: true },
  },
  kinds: KIND,
  meanings: MEANING,
};

/** Where the handles of a SixPoint ramp stand. */
export function handlesOf(
  design: Design,
  mode: Mode,
  phases: readonly Stretch[],
  durationS: number,
  way: 1 | -1,
): Handle<Drawn>[] {
  return handlesIn(LAYOUT, design, used(mode), phases, durationS, way);
}
