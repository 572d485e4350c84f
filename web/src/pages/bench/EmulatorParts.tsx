import { Button, Divider, Group, SegmentedControl, Slider, Switch, Text } from "@mantine/core";
import { IconPower } from "@tabler/icons-react";
import type { ReactNode } from "react";
import { optionsOf } from "../../lib/choices";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { useHeld } from "../../lib/useHeld";

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
        aria-label={`${label} switch of ${of}`}
        data={optionsOf({ auto: "stage", on: "on", off: "off" })}
        value={forced === null ? "auto" : forced ? "on" : "off"}
        onChange={(value) => onChange(value === "auto" ? "auto" : value === "on")}
      />
    </Group>
  );
}

interface TimeProps {
  state: { time_scale: number; chip_time_s: number };
  send: (change: { time_scale: number }) => void;
}

/** How fast the emulator's time passes. */
export function EmulatorTime({ state, send }: TimeProps) {
  const { time_scale: scale, chip_time_s: chipTimeS } = state;
  const index = SCALES.findIndex((candidate) => candidate >= scale);
  const [shown, hold] = useHeld(index < 0 ? SCALES.length - 1 : index);
  return (
    <>
      <Divider label="Time" labelPosition="left" />
      <Slider
        thumbSize={16}
        size="md"
        thumbLabel="Time scale"
        min={0}
        max={SCALES.length - 1}
        step={1}
        value={shown}
        onChange={(chosen) => {
          hold(chosen);
          send({ time_scale: SCALES[chosen] ?? 1 });
        }}
        label={(chosen) => `${SCALES[chosen]} x`}
        marks={SCALES.map((each, place) => ({ value: place, label: String(each) }))}
        mb="lg"
      />
      <Text size="xs" c="dimmed">
        Chip time <span className="num">{fixed(chipTimeS, 1, "s")}</span>, {scale} times real time
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
  const [shown, hold] = useHeld(value);
  return (
    <div>
      <Group justify="space-between" gap={4}>
        <Text size="xs">Load torque, pulls to the left</Text>
        <Text size="xs" className="num">
          {fixed(shown * 1000, 0, "mN·m")}
        </Text>
      </Group>
      <Slider
        thumbSize={16}
        size="md"
        thumbLabel="Load torque"
        min={-most}
        max={most}
        step={0.005}
        value={shown}
        label={(torque) => fixed(torque * 1000, 0, "mN·m")}
        marks={[{ value: 0 }]}
        onChange={(torque) => {
          hold(torque);
          send(torque);
        }}
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
export type Places = Record<(typeof PLACES)[number][0], number>;

interface PlacesProps {
  stage: Places;
  /** it has a home switch */
  home: boolean;
  send: (places: Partial<Places>) => void;
}

/** Where the switches of a stage stand, and its carriage. */
export function StagePlacesFields({ stage, home, send }: PlacesProps) {
  return (
    <div className="halves gap-6">
      {PLACES.filter(([name]) => home || !name.startsWith("home")).map(([name, label]) => (
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

type FaultChange<Name extends string> = Partial<Record<Name, boolean> & { bit_error_rate: number }>;

interface FaultProps<Name extends string> {
  faults: Readonly<Record<Name, boolean>> & { bit_error_rate: number };
  /** those that are there or not, as they are called here */
  names: readonly (readonly [name: Name, label: string])[];
  send: (faults: FaultChange<Name>) => void;
  /** further ones, with a number each */
  children?: ReactNode;
}

/** What can go wrong between the emulated device and us. */
export function Faults<Name extends string>({ faults, names, send, children }: FaultProps<Name>) {
  return (
    <>
      <Divider label="Faults" labelPosition="left" />
      {names.map(([name, label]) => (
        <Switch
          key={name}
          size="sm"
          label={label}
          checked={faults[name]}
          onChange={(event) => send({ [name]: event.currentTarget.checked } as FaultChange<Name>)}
        />
      ))}
      <div className="halves gap-6">
        <NumberField
          label="Bit error rate"
          title="the share of bits of replies that are turned over"
          value={faults.bit_error_rate}
          min={0}
          max={1}
          step={0.001}
          onChange={(rate) => send({ bit_error_rate: rate } as FaultChange<Name>)}
        />
        {children}
      </div>
    </>
  );
}

interface PowerProps {
  send: (change: { power_cycle: true }) => void;
  /** what it does, and what not */
  note: string;
  /** beside the button */
  children?: ReactNode;
}

/** Off and on again. */
export function Power({ send, note, children }: PowerProps) {
  return (
    <>
      <Divider label="Power" labelPosition="left" />
      <Group gap={6} grow wrap="nowrap">
        <Button
          variant="default"
          leftSection={<IconPower size={16} aria-hidden />}
          onClick={() => send({ power_cycle: true })}
          data-testid="power-cycle"
        >
          Power cycle
        </Button>
        {children}
      </Group>
      <Text size="xs" c="dimmed">
        {note}
      </Text>
    </>
  );
}
