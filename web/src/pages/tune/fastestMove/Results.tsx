import type { Study } from "../study";
import type { Changes } from "../useStudies";
import { Distances } from "./Distances";
import { Evidence } from "./Evidence";
import { Front } from "./Front";
import { MovePlot } from "./MovePlot";
import { TrialPlots } from "./TrialPlots";

/** The move itself, how sure it is, what may be chosen of two objectives, and what was tried. */
export function Results({ study, changes }: { study: Study; changes: Changes }) {
  return (
    <>
      {study.moves.length > 0 && <MovePlot study={study} />}
      <Distances study={study} />
      {study.evidence && <Evidence study={study} evidence={study.evidence} />}
      {study.front.length > 0 && <Front study={study} changes={changes} />}
      {study.trials.length > 0 && <TrialPlots study={study} />}
    </>
  );
}
