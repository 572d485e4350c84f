import { Button } from "@mantine/core";
import { StartUpButton } from "../startup/StartUpButton";
import { sentence } from "./kinds";
import type { Remedies, Remedy } from "./remedy";

interface Props {
  remedy: Remedy;
  remedies: Remedies;
  main?: boolean;
  /** it has put right what it is beside */
  onDone?: (() => void) | undefined;
}

const START_UP = /^\/api\/v1\/devices\/([^/]+)\/start-up$/;

/** What helps, as a button that does it; one that moves the motor says so. A start-up shows first what it would write. */
export function RemedyButton({ remedy, remedies, main = false, onDone }: Props) {
  const device = START_UP.exec(remedy.path)?.[1];
  if (device !== undefined)
    return (
      <StartUpButton
        size="compact-sm"
        variant={main ? "filled" : "default"}
        device={decodeURIComponent(device)}
        axes={(remedy.body as { axes?: number[] } | null)?.axes ?? null}
        label={sentence(remedy.label)}
        onDone={onDone}
      />
    );
  return (
    <Button
      size="compact-sm"
      variant={main ? "filled" : "default"}
      loading={remedies.isPending && remedies.variables === remedy}
      disabled={remedies.isPending}
      data-testid="remedy"
      onClick={() => remedies.mutate(remedy, { onSuccess: () => onDone?.() })}
    >
      {sentence(remedy.label)}
      {remedy.moves && " (moves)"}
    </Button>
  );
}
