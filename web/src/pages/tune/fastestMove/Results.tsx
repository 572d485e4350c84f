import { Text } from "@mantine/core";
import { compact, counted } from "../../../lib/format";
import type { Study } from "../study";
import { TrialsCard } from "../trials/TrialsCard";
import type { Changes } from "../useStudies";
import { Distances } from "./Distances";
import { Evidence } from "./Evidence";
import { Front } from "./Front";
import { MovePlot } from "./MovePlot";
import { pointsOf } from "./trials";

/** The move itself, how sure it is, what may be chosen of two objectives, and what was tried. */
export function Results({ study, changes }: { study: Study; changes: Changes }) {
  return (
    <>
      {study.moves.length > 0 && <MovePlot study={study} />}
      <Distances study={study} />
      {study.evidence && <Evidence study={study} evidence={study.evidence} />}
      {study.front.length > 0 && <Front study={study} changes={changes} />}
      <TrialsCard trials={pointsOf(study)} space>
        <Text size="sm" className="dim">
          Way of the motor so far: {compact(study.way_fullsteps)} full steps in {counted(study.runs, "run")}.
        </Text>
      </TrialsCard>
    </>
  );
}
