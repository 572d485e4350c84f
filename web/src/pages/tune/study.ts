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

/** Units of which a motor has thousandths, and one of which it has far less. */
const LARGE = new Set(["H", "N m", "N m s", "V s/rad"]);

/** What of a finding stands beside its name, and how sure that is: 4.40 mH, 95 %: 4.10 to 4.70. */
export function figureOf({ value, unit, interval }: Finding): { figure: string; sure: string } {
  if (value === null) return { figure: "", sure: "" };
  const small = LARGE.has(unit) && value !== 0 && Math.abs(value) < 0.1;
  const per = unit.startsWith("kg m2") ? 1e7 : small ? 1e3 : 1;
  const symbol = `${small ? "m" : ""}${unit.replace("kg m2", "g cm²").replace("ohm", "Ω").replace("^2", "²")}`;
  const text = (at: number) => compact(at * per);
  const sure = interval === null ? "" : `95 %: ${text(interval.low)} to ${text(interval.high)}`;
  return { figure: `${text(value)} ${symbol}`.trim(), sure };
}

/** "VMAX of axis 0", "AMAX of axis 0", "GCONF": VMAX, AMAX of axis 0; GCONF. */
export function namedOnce(registers: readonly string[]): string {
  const names = new Map<string, string[]>();
  for (const each of registers) {
    const [name = "", of = ""] = each.split(" of ");
    names.set(of, [...(names.get(of) ?? []), name]);
  }
  return [...names].map(([of, each]) => each.join(", ") + (of && ` of ${of}`)).join("; ");
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

/** What the motor of its twin was made of, or why none was tried; empty where its document says so itself. */
export function twinTold({ document: { study }, no_twin }: Study): string {
  if (no_twin) return `Not tried on an emulated twin first: ${no_twin}.`;
  const twin = "twin" in study && typeof study.twin === "object" ? study.twin : null;
  return twin?.source ? `Tried on an emulated twin first: ${twin.source}.` : "";
}
