import { Button } from "@mantine/core";
import { sentence } from "./kinds";
import type { Remedies, Remedy } from "./remedy";

interface Props {
  remedy: Remedy;
  remedies: Remedies;
  main?: boolean;
}

/** What helps, as a button that does it; one that moves the motor says so. */
export function RemedyButton({ remedy, remedies, main = false }: Props) {
  return (
    <Button
      size="compact-sm"
      variant={main ? "filled" : "default"}
      loading={remedies.isPending && remedies.variables === remedy}
      disabled={remedies.isPending}
      data-testid="remedy"
      onClick={() => remedies.mutate(remedy)}
    >
      {sentence(remedy.label)}
      {remedy.moves && " (moves)"}
    </Button>
  );
}
