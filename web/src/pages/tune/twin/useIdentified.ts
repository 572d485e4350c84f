import { dateTimeOf } from "../../../lib/time";
import { useStudies, useStudy } from "../useStudies";
import type { Identified } from "./form";

/** What the latest study of motor and machine found of an axis, and when; null where there is none. */
export function useIdentified(device: string, axis: number): { found: Identified; when: string } | null {
  const latest = useStudies().data?.studies.find(
    (study) =>
      study.device === device && study.axis === axis && study.kind === "identification" && study.state === "done",
  );
  const study = useStudy(latest?.id ?? null).data;
  if (!study?.identified) return null;
  return { found: study.identified, when: dateTimeOf(study.started_unix_s * 1000) };
}
