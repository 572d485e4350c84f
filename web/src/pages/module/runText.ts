import { ApiError } from "../../api/client";
import { fixed } from "../../lib/format";
import { HOLD_S, type RunState } from "./HeldRun";
import { REASONS, type StopReason } from "./useStops";

/** Why a run is over that nobody on this page ended; null for any other. */
export function endText(state: RunState): string | null {
  if (state.phase === "stuck")
    return `Ended: ${(REASONS[state.reason as StopReason]?.text ?? state.reason).toLowerCase()}.`;
  if (state.phase !== "ended") return null;
  if (state.unheardS !== undefined)
    return `The server stopped the motor: it had heard nothing of this tab for ${fixed(state.unheardS, 1, "s")}, and ${HOLD_S} s is the most. Browsers slow down tabs that nobody looks at.`;
  if (isRefusal(state.error)) return "Something else has stopped the motor: see what, in the list of stops.";
  return `Turning failed: ${state.error instanceof Error ? state.error.message : String(state.error)}`;
}

/** Whether the server said that there is nothing to keep up any more. */
export function isRefusal(error: unknown): boolean {
  return error instanceof ApiError && error.problem.status === 409;
}
