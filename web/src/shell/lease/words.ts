import type { Lease, OnVanish } from "../../api/lease/LeaseClient";
import { fixed } from "../../lib/format";

/** "12 s", "3 min", "2 h": how long a session has had the bench, or will have it. */
export function lasting(seconds: number | null): string {
  if (seconds === null || !Number.isFinite(seconds)) return "";
  const whole = Math.max(0, Math.round(seconds));
  if (whole < 60) return fixed(whole, 0, "s");
  return whole < 3600 ? `${Math.floor(whole / 60)} min` : `${Math.floor(whole / 3600)} h`;
}

/** A sign is due every five seconds: of a holder that has let two go by nothing may ever be heard again. */
const SILENT_S = 11;

export function isSilent(lease: Lease): boolean {
  return lease.expires_in_s !== null && lease.vanish_after_s - lease.expires_in_s > SILENT_S;
}

export const ON_VANISH: Readonly<Record<OnVanish, { label: string; what: string }>> = {
  stop: { label: "Stop", what: "Every motor slows down and stops." },
  hold: { label: "Hold", what: "Rotations and procedures end; a move runs to its target and holds." },
  nothing: { label: "Go on", what: "Motors go on as they are." },
};
