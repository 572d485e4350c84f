import { Text } from "@mantine/core";
import { ProblemAlert } from "../../lib/ProblemAlert";
import type { RunState } from "./HeldRun";
import { endText, isRefusal } from "./runText";

/** How a run goes, in one line of fixed height. */
export function RunNote({ state, idle }: { state: RunState; idle: string }) {
  if (state.phase === "ended" && state.unheardS === undefined && !isRefusal(state.error))
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
    case "idle":
      return idle;
    default:
      return endText(state) ?? idle;
  }
}
