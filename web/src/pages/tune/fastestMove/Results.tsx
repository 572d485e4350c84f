import type { Study } from "../study";
import { Evidence } from "./Evidence";
import { TrialPlots } from "./TrialPlots";

/** How sure it is, and what was tried. */
export function Results({ study }: { study: Study }) {
  return (
    <>
      {study.evidence && <Evidence study={study} evidence={study.evidence} />}
      {study.trials.length > 0 && <TrialPlots study={study} />}
    </>
  );
}
