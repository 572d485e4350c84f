import { Group, SegmentedControl, Slider, Text } from "@mantine/core";
import { useState } from "react";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import classes from "./bench.module.css";

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

interface LoadProps {
  value: number;
  /** the slider's ends, both ways [Nm] */
  most: number;
  send: (torque: number) => void;
}

/** Sends while it is dragged, and shows the hand's value, not the answer that is still under way. */
export function LoadSlider({ value, most, send }: LoadProps) {
  const [held, setHeld] = useState<number | null>(null);
  const shown = held ?? value;
  return (
    <div>
      <Group justify="space-between" gap={4}>
        <Text size="xs">Load torque, pulls to the left</Text>
        <Text size="xs" className="num">
          {fixed(shown * 1000)} mN·m
        </Text>
      </Group>
      <Slider
        thumbLabel="Load torque"
        min={-most}
        max={most}
        step={0.005}
        value={shown}
        label={(torque) => `${fixed(torque * 1000)} mN·m`}
        marks={[{ value: 0 }]}
        onChange={(torque) => {
          setHeld(torque);
          send(torque);
        }}
        onChangeEnd={() => setHeld(null)}
      />
    </div>
  );
}

const PLACES = [
  ["left_at_fullsteps", "Left at"],
  ["right_at_fullsteps", "Right at"],
  ["home_from_fullsteps", "Home from"],
  ["home_to_fullsteps", "Home to"],
  ["position_fullsteps", "Carriage at"],
] as const;
type Places = Record<(typeof PLACES)[number][0], number>;

interface PlacesProps {
  stage: Places;
  send: (places: Partial<Places>) => void;
}

/** Where the switches of a stage stand, and its carriage. */
export function StagePlacesFields({ stage, send }: PlacesProps) {
  return (
    <div className={classes.pairGrid}>
      {PLACES.map(([name, label]) => (
        <NumberField
          key={name}
          label={label}
          unit="fs"
          title="full steps of the motor"
          value={stage[name]}
          show={(value) => String(Math.round(value * 10) / 10)}
          min={-1e6}
          max={1e6}
          step={10}
          onChange={(value) => send({ [name]: value })}
        />
      ))}
    </div>
  );
}
