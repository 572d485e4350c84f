import { Button, Divider, Switch, Text } from "@mantine/core";
import { IconPower } from "@tabler/icons-react";
import type { Device } from "../../api/queries";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import classes from "./bench.module.css";
import { SwitchRow, TimeScale } from "./EmulatorParts";
import type { ChipAxis, ChipPatch, ChipState } from "./useEmulator";

const SWITCHES = [
  ["left", "Left"],
  ["reference", "Reference"],
  ["right", "Right"],
] as const;

interface Props {
  device: Device;
  state: ChipState;
  send: (patch: ChipPatch) => void;
}

/** The world of an emulated chip: switches, time, faults, power. */
export function ChipControls({ device, state, send }: Props) {
  return (
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
      <TimeScale scale={state.time_scale} chipTimeS={state.chip_time_s} send={(time_scale) => send({ time_scale })} />
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
  );
}

interface AxisProps {
  name: string;
  axis: ChipAxis;
  send: (patch: ChipPatch) => void;
}

function AxisSwitches({ name, axis, send }: AxisProps) {
  return (
    <fieldset className={classes.fieldset}>
      <legend>
        {name}
        <span className="num">{fixed(axis.position_fullsteps, 1)} full steps</span>
      </legend>
      {SWITCHES.map(([key, label]) => (
        <SwitchRow
          key={key}
          label={label}
          of={name}
          forced={axis.switches[key].forced}
          onChange={(value) => send({ switches: [{ axis: axis.axis, [key]: value }] })}
        />
      ))}
    </fieldset>
  );
}
