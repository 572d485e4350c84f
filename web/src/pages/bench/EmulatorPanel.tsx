import {
  Button,
  CloseButton,
  Divider,
  Group,
  SegmentedControl,
  Slider,
  Stack,
  Switch,
  Text,
  Title,
} from "@mantine/core";
import { IconPower } from "@tabler/icons-react";
import type { Device } from "../../api/queries";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import classes from "./bench.module.css";
import { type EmulatorAxis, type EmulatorPatch, useChangeEmulator, useEmulator } from "./useEmulator";

interface Props {
  device: Device;
  onClose: () => void;
}

const SWITCHES = [
  ["left", "Left"],
  ["reference", "Reference"],
  ["right", "Right"],
] as const;

const SCALES = [0, 0.1, 0.25, 0.5, 1, 2, 5, 10] as const;

/** The world behind an emulated chip's pins, to be played with: switches, faults, time, power. */
export function EmulatorPanel({ device, onClose }: Props) {
  const emulator = useEmulator(device, true);
  const change = useChangeEmulator(device.id);
  const state = emulator.data;
  const send = (patch: EmulatorPatch) => change.mutate(patch);
  const scaleIndex = SCALES.findIndex((scale) => scale >= (state?.time_scale ?? 1));
  return (
    <aside className={classes.emulator} aria-label={`Emulator of ${device.name}`} data-testid="emulator">
      <Group justify="space-between" wrap="nowrap" mb={4}>
        <Title order={2} className={classes.cardTitle}>
          Emulator of {device.name}
        </Title>
        <CloseButton size="sm" aria-label="Close the emulator panel" onClick={onClose} />
      </Group>
      <Stack gap="sm">
        {(change.error ?? emulator.error) && (
          <ProblemAlert error={change.error ?? emulator.error} doing="Changing the emulator" onClose={change.reset} />
        )}
        {state && (
          <>
            <Divider label="Switches" labelPosition="left" />
            {state.axes.map((axis) => (
              <AxisSwitches
                key={axis.axis}
                name={device.axes[axis.axis]?.name ?? String(axis.axis)}
                axis={axis}
                send={send}
              />
            ))}
            <Divider label="Time" labelPosition="left" />
            <Slider
              thumbLabel="Time scale"
              min={0}
              max={SCALES.length - 1}
              step={1}
              value={scaleIndex < 0 ? SCALES.length - 1 : scaleIndex}
              onChange={(index) => send({ time_scale: SCALES[index] ?? 1 })}
              label={(index) => `${SCALES[index]} x`}
              marks={SCALES.map((scale, index) => ({ value: index, label: String(scale) }))}
              mb="lg"
            />
            <Text size="xs" c="dimmed">
              Chip time <span className="num">{fixed(state.chip_time_s, 1)} s</span>, {state.time_scale} times real time
            </Text>
            <Divider label="Faults" labelPosition="left" />
            <Switch
              size="sm"
              label="Silent: frames get no answer"
              checked={state.faults.silence}
              onChange={(event) => send({ faults: { silence: event.currentTarget.checked } })}
            />
            <Switch
              size="sm"
              label="Unplugged: the link is gone"
              checked={state.faults.unplugged}
              onChange={(event) => send({ faults: { unplugged: event.currentTarget.checked } })}
            />
            <NumberField
              label="Bit error rate of replies"
              value={state.faults.bit_error_rate}
              min={0}
              max={1}
              step={0.001}
              onChange={(rate) => send({ faults: { bit_error_rate: rate } })}
            />
            <Divider label="Power" labelPosition="left" />
            <Button
              size="xs"
              variant="default"
              leftSection={<IconPower size={16} aria-hidden />}
              onClick={() => send({ power_cycle: true })}
            >
              Power cycle
            </Button>
            <Text size="xs" c="dimmed">
              Resets the chip: registers and RAM lose what was set. The carriages stay where they are.
            </Text>
          </>
        )}
      </Stack>
    </aside>
  );
}

interface AxisProps {
  name: string;
  axis: EmulatorAxis;
  send: (patch: EmulatorPatch) => void;
}

function AxisSwitches({ name, axis, send }: AxisProps) {
  return (
    <fieldset className={classes.fieldset}>
      <legend>
        {name}
        <span className="num">{fixed(axis.position_fullsteps, 1)} full steps</span>
      </legend>
      {SWITCHES.map(([key, label]) => {
        const forced = axis.switches[key].forced;
        return (
          <Group key={key} justify="space-between" wrap="nowrap" gap="xs">
            <Text size="xs">{label}</Text>
            <SegmentedControl
              size="xs"
              aria-label={`${label} switch of ${name}`}
              data={[
                { value: "auto", label: "stage" },
                { value: "on", label: "on" },
                { value: "off", label: "off" },
              ]}
              value={forced === null ? "auto" : forced ? "on" : "off"}
              onChange={(value) =>
                send({ switches: [{ axis: axis.axis, [key]: value === "auto" ? "auto" : value === "on" }] })
              }
            />
          </Group>
        );
      })}
    </fieldset>
  );
}
