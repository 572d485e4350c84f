import { Group } from "@mantine/core";
import { RemedyButton } from "./condition/RemedyButton";
import { type Remedy, useRemedies } from "./condition/remedy";

interface Props {
  remedies: readonly Remedy[];
  /** what one of them has put right need not be shown any more */
  onDone?: (() => void) | undefined;
}

/** Calls that put a refusal right, as buttons beside it. */
export function Remedies({ remedies, onDone }: Props) {
  const call = useRemedies();
  if (remedies.length === 0) return null;
  return (
    <Group gap="xs" mt="xs">
      {remedies.map((remedy, index) => (
        <RemedyButton
          key={`${remedy.path} ${remedy.label}`}
          remedy={remedy}
          remedies={call}
          main={index === 0}
          onDone={onDone}
        />
      ))}
    </Group>
  );
}
