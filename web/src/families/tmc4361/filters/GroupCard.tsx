import { Checkbox, NativeSelect, Radio, Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { frequency } from "../../../lib/format";
import classes from "./filters.module.css";
import { type FilterGroup, timeText } from "./waves";

export interface GroupSetting {
  sampleRate: number;
  length: number;
  stepInput: number;
  staged: boolean;
  known: boolean;
}

const TITLES: Record<string, string> = {
  enc_in: "Encoder inputs",
  ref: "Reference switches",
  s: "Start signal",
  enc_out: "Serial encoder output",
};
const RATES = [0, 1, 2, 3, 4, 5, 6, 7];

interface Props {
  group: FilterGroup;
  setting: GroupSetting;
  clockHz: number;
  chosen: boolean;
  onChoose: () => void;
  onChange: (part: Partial<GroupSetting>) => void;
}

/** One of the four filters: its pins, its two settings, and what they come to. */
export function GroupCard({ group, setting, clockHz, chosen, onChoose, onChange }: Props) {
  const title = TITLES[group.suffix] ?? group.suffix;
  const stopped = (setting.length * 2 ** setting.sampleRate) / clockHz;
  return (
    // Pointers may choose the whole card; the radio in it is for everybody.
    <Card
      as="div"
      className={`pad ${chosen ? classes.chosen : ""}`}
      data-staged={setting.staged}
      onClick={onChoose}
      data-testid={`group-${group.suffix}`}
    >
      <Radio
        name="input-filter-group"
        checked={chosen}
        onChange={onChoose}
        label={title}
        classNames={{ label: "bold" }}
      />
      <Text size="xs" c="dimmed" className="anywhere" pl={24}>
        {group.pins.join(", ")}
      </Text>
      <div className="halves gap-8 mt-4">
        <NativeSelect
          label={group.sample_rate_field}
          aria-label={`Sample rate of ${title}, ${group.sample_rate_field}`}
          value={String(setting.sampleRate)}
          data={RATES.map((rate) => ({
            value: String(rate),
            label: `${rate} · ${frequency(clockHz / 2 ** rate)}`,
          }))}
          onChange={(event) => onChange({ sampleRate: Number(event.currentTarget.value) })}
        />
        <NativeSelect
          label={group.length_field}
          aria-label={`Length of ${title}, ${group.length_field}`}
          value={String(setting.length)}
          data={RATES.map((length) => ({
            value: String(length),
            label: length === 0 ? "0 · off" : `${length} · ${length + 1} equal`,
          }))}
          onChange={(event) => onChange({ length: Number(event.currentTarget.value) })}
        />
      </div>
      <Checkbox
        mt={6}
        label="also for STPIN and DIRIN"
        title={group.step_input_field}
        checked={setting.stepInput === 1}
        onChange={(event) => onChange({ stepInput: event.currentTarget.checked ? 1 : 0 })}
      />
      <Text size="xs" mt={4} className={setting.staged ? "accent" : "dim"}>
        {!setting.known
          ? "The chip's setting is not known."
          : setting.length === 0
            ? "No filtering: each sample counts."
            : `Stops pulses up to ${timeText(stopped)}.`}
        {setting.staged && " Not applied."}
      </Text>
    </Card>
  );
}
