import { fixed } from "../../lib/format";
import { timeOf } from "../../lib/time";
import type { Entry, Outcome } from "./filters";

/** 18:45:09.3, in the browser's zone. */
export function timeText(iso: string): string {
  const at = new Date(iso);
  return `${timeOf(at)}.${Math.floor(at.getMilliseconds() / 100)}`;
}

/** A number with a real minus and thin spaces, a text as it is, nothing for nothing. */
export function valueText(value: Entry["old"]): string {
  if (value === null) return "";
  if (typeof value === "string") return value;
  return Number.isInteger(value) ? fixed(value) : String(value).replace("-", "−");
}

/** The fields of a register that are others now say more than its bits: `toff 3 -> 4`. */
export function hasFields({ action, detail }: Entry): boolean {
  return action === "write" && detail.includes("-> ");
}

/** An arrow as people draw it. */
export function detailText(detail: string): string {
  return detail.replaceAll("-> ", "→ ");
}

/** What came of it, and why. */
export function outcomeOf({ outcome }: Entry): { kind: Outcome; why: string } {
  const [kind = "done", ...why] = outcome.split(": ");
  return { kind: kind === "refused" || kind === "not proven" ? kind : "done", why: why.join(": ") };
}
