import type { Study } from "../study";
import { Distances } from "./Distances";
import { Evidence } from "./Evidence";
import { MovePlot } from "./MovePlot";
import { TrialPlots } from "./TrialPlots";

/** The move itself, how sure it is, and what was tried. */
export function Results({ study }: { study: Study }) {
  return (
    <>
      {study.moves.length > 0 && <MovePlot study={study} />}
      <Distances study={study} />
      {study.evidence && <Evidence study={study} evidence={study.evidence} />}
      {study.trials.length > 0 && <TrialPlots study={study} />}
    </>
  );
}
