import { Checkbox, Divider, Stack, Text } from "@mantine/core";

interface Choice {
  label: string;
  chosen: boolean;
  toggle: () => void;
}

interface Props {
  rows: readonly Choice[];
  /** axes besides the one in the hand */
  others: readonly Choice[];
}

/** What the scope shows: its plots, and further axes. */
export function ScopeChoices({ rows, others }: Props) {
  return (
    <Stack gap={6}>
      <Choices title="Plots" choices={rows} />
      {others.length > 0 && (
        <>
          <Divider />
          <Choices title="Also show" choices={others} />
        </>
      )}
    </Stack>
  );
}

function Choices({ title, choices }: { title: string; choices: readonly Choice[] }) {
  return (
    <>
      <Text size="xs" fw={600}>
        {title}
      </Text>
      {choices.map(({ label, chosen, toggle }) => (
        <Checkbox key={label} size="xs" label={label} checked={chosen} onChange={toggle} />
      ))}
    </>
  );
}
