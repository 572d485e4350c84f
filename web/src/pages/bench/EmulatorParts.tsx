import { Group, SegmentedControl, Slider, Text } from "@mantine/core";
import { fixed } from "../../lib/format";

const SCALES = [0, 0.1, 0.25, 0.5, 1, 2, 5, 10] as const;

interface SwitchProps {
  label: string;
  /** whose switch it is, for those who do not see where it stands */
  of: string;
  forced: boolean | null;
  onChange: (value: boolean | "auto") => void;
}

/** A switch that follows the stage, or is held on or off. */
export function SwitchRow({ label, of, forced, onChange }: SwitchProps) {
  return (
    <Group justify="space-between" wrap="nowrap" gap="xs">
      <Text size="xs">{label}</Text>
      <SegmentedControl
        size="xs"
        aria-label={`${label} switch of ${of}`}
        data={[
          { value: "auto", label: "stage" },
          { value: "on", label: "on" },
          { value: "off", label: "off" },
        ]}
        value={forced === null ? "auto" : forced ? "on" : "off"}
        onChange={(value) => onChange(value === "auto" ? "auto" : value === "on")}
      />
    </Group>
  );
}

interface TimeProps {
  scale: number;
  chipTimeS: number;
  send: (scale: number) => void;
}

/** How fast the emulator's time passes. */
export function TimeScale({ scale, chipTimeS, send }: TimeProps) {
  const index = SCALES.findIndex((candidate) => candidate >= scale);
  return (
    <>
      <Slider
        thumbLabel="Time scale"
        min={0}
        max={SCALES.length - 1}
        step={1}
        value={index < 0 ? SCALES.length - 1 : index}
        onChange={(chosen) => send(SCALES[chosen] ?? 1)}
        label={(chosen) => `${SCALES[chosen]} x`}
        marks={SCALES.map((each, place) => ({ value: place, label: String(each) }))}
        mb="lg"
      />
      <Text size="xs" c="dimmed">
        Chip time <span className="num">{fixed(chipTimeS, 1)} s</span>, {scale} times real time
      </Text>
    </>
  );
}
