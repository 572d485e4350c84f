import { Text } from "@mantine/core";
import { ApiError } from "../../api/client";
import { ProblemAlert } from "../../lib/ProblemAlert";
import type { RunState } from "./HeldRun";
import { REASONS, type StopReason } from "./useStops";

/** How a run goes, in one line of fixed height. */
export function RunNote({ state, idle }: { state: RunState; idle: string }) {
  if (state.phase === "ended" && !(state.error instanceof ApiError && state.error.problem.status === 409))
    return <ProblemAlert error={state.error} doing="Turning" />;
  return (
    <Text size="xs" c="dimmed" mih={34} role="status" data-testid="run-note" data-phase={state.phase}>
      {textOf(state, idle)}
    </Text>
  );
}

function textOf(state: RunState, idle: string): string {
  switch (state.phase) {
    case "running":
      return `Turning, part ${state.leg + 1} of ${state.legs}. It ends by itself, and when this tab is closed; other pages show it.`;
    case "done":
      return "Done.";
    case "stopped":
      return "Stopped.";
    case "stuck":
      return `Ended: ${(REASONS[state.reason as StopReason]?.text ?? state.reason).toLowerCase()}.`;
    case "ended":
      return "Something else has stopped the motor: see what, in the list of stops.";
    default:
      return idle;
  }
}
