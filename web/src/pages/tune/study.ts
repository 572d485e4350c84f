import type { Schemas } from "../../api/client";
import type { Remedy } from "../../lib/condition/remedy";
import { compact } from "../../lib/format";

export type Study = Schemas["StudyRecord"];
export type StudyInfo = Schemas["StudyInfo"];
export type Plan = Schemas["StudyPlan"];
export type Wish = Schemas["StudyDocument-Input"];
export type Kind = StudyInfo["kind"];
export type Trial = Study["trials"][number];
export type Finding = Study["findings"][number];

/** What of a finding stands beside its name: 0.25 deg, 0.2 to 0.3. */
export function figureOf({ value, unit, interval }: Finding): string {
  if (value === null) return "";
  const between = interval === null ? "" : ` (95 %: ${compact(interval.low)} to ${compact(interval.high)})`;
  return `${compact(value)} ${unit}`.trim() + between;
}

/** A cure as the page makes it: its address stands behind the device's own. */
export function remedyOf(device: string, { remedy }: Finding): Remedy | null {
  if (remedy === null) return null;
  return { ...remedy, path: `/api/v1/devices/${encodeURIComponent(device)}/${remedy.path}` };
}

/** A verdict's sentences: what came of it first, then its grounds. A semicolon within brackets parts nothing. */
export function sentencesOf(verdict: string): string[] {
  return verdict.split(/; (?![^(]*\))|\. (?=[A-Z])/);
}
