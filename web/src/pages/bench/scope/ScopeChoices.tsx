import { Checkbox, Divider, MultiSelect, Stack, Text } from "@mantine/core";
import { MORE_MAX } from "./rows";

interface Choice {
  label: string;
  chosen: boolean;
  toggle: () => void;
}

interface Props {
  rows: readonly Choice[];
  /** axes besides the one in the hand */
  others: readonly Choice[];
  /** registers or parameters without a plot of their own, by name */
  further: readonly string[];
  more: string[];
  onMore: (more: string[]) => void;
  marks: boolean;
  onMarks: (marks: boolean) => void;
}

/** What the scope shows: its plots, and further axes. */
export function ScopeChoices({ rows, others, further, more, onMore, marks, onMarks }: Props) {
  return (
    <Stack gap={6}>
      {rows.length > 0 && <Choices title="Plots" choices={rows} />}
      {further.length > 0 && (
        <MultiSelect
          w={260}
          label="Registers and parameters"
          placeholder={more.length === 0 ? "any of them, by name" : ""}
          data={[...further]}
          value={more.filter((name) => further.includes(name))}
          onChange={onMore}
          maxValues={MORE_MAX}
          searchable
          hidePickedOptions
          nothingFoundMessage="Nothing of that name"
          comboboxProps={{ withinPortal: false }}
        />
      )}
      <Divider />
      <Checkbox
        label="Writes, stops and events as marks"
        checked={marks}
        onChange={(event) => onMarks(event.currentTarget.checked)}
      />
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
        <Checkbox key={label} label={label} checked={chosen} onChange={toggle} />
      ))}
    </>
  );
}
