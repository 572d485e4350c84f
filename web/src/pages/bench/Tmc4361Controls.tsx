import { Button, Divider, Group, Switch, Text } from "@mantine/core";
import { IconPower } from "@tabler/icons-react";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import classes from "./bench.module.css";
import { LoadSlider, StagePlacesFields, SwitchRow, TimeScale } from "./EmulatorParts";
import { RotorDial } from "./RotorDial";
import type { Tmc4361Patch, Tmc4361State } from "./useEmulator";

interface Props {
  state: Tmc4361State;
  send: (patch: Tmc4361Patch) => void;
}

/** The world of an emulated TMC4361: what pulls at its shaft, its encoder, stage and pins; and how the rotor is. */
export function Tmc4361Controls({ state, send }: Props) {
  const { faults, encoder, motor, pins } = state;
  // the slider goes a little beyond what the motor holds
  const most = Math.ceil(motor.holding_torque_nm * 1200) / 1000;
  return (
    <>
      <RotorDial truth={state.truth} />
      <Divider label="Shaft" labelPosition="left" />
      <LoadSlider value={state.load_torque_nm} most={most} send={(load_torque_nm) => send({ load_torque_nm })} />
      <div className={classes.pairGrid}>
        <NumberField
          label="Friction"
          unit="N·m"
          value={state.friction}
          min={0}
          max={50}
          step={0.01}
          onChange={(friction) => send({ friction })}
        />
        <NumberField
          label="Supply"
          unit="V"
          value={state.supply_v}
          min={0}
          max={60}
          step={1}
          onChange={(supply_v) => send({ supply_v })}
        />
      </div>
      <Switch
        size="sm"
        label="Shaft blocked"
        checked={state.blocked}
        onChange={(event) => send({ blocked: event.currentTarget.checked })}
        data-testid="blocked"
      />
      <Switch
        size="sm"
        label="Motor plugged in"
        checked={motor.connected}
        onChange={(event) => send({ motor: { connected: event.currentTarget.checked } })}
      />
      <Divider label="Encoder" labelPosition="left" />
      <Text size="xs" c="dimmed">
        {encoder.kind}, <span className="num">{fixed(encoder.counts_per_turn)}</span> counts a turn
      </Text>
      <Group gap={6} wrap="nowrap" align="flex-end">
        <NumberField
          label="Eccentricity"
          unit="°"
          value={encoder.eccentricity_deg}
          min={0}
          max={10}
          step={0.1}
          flex={1}
          onChange={(eccentricity_deg) => send({ encoder: { eccentricity_deg } })}
        />
        <Button
          size="xs"
          variant="default"
          title={`The encoder turns on the shaft by one full step; ${fixed(encoder.slip_fullsteps, 1)} so far`}
          onClick={() => send({ encoder: { slip_fullsteps: encoder.slip_fullsteps + 1 } })}
          data-testid="slip"
        >
          Slip 1 step
        </Button>
      </Group>
      <Divider label="Switches and stage" labelPosition="left" />
      <div className={classes.fieldset}>
        {(["left", "home", "right"] as const).map((name) => (
          <SwitchRow
            key={name}
            label={name === "home" ? "HOME_REF" : name === "left" ? "STOPL" : "STOPR"}
            of="the stage"
            forced={state.switches[name].forced}
            onChange={(value) => send({ switches: { [name]: value } })}
          />
        ))}
      </div>
      <StagePlacesFields stage={state.stage} send={(places) => send({ stage: places })} />
      <Divider label="Pins" labelPosition="left" />
      <div className={classes.fieldset}>
        {(
          [
            ["start", "START"],
            ["freeze", "NFREEZE"],
          ] as const
        ).map(([name, label]) => (
          <SwitchRow
            key={name}
            label={label}
            of="the chip"
            forced={pins[name].forced}
            onChange={(value) => send({ pins: { [name]: value } })}
          />
        ))}
      </div>
      <Divider label="Time" labelPosition="left" />
      <TimeScale scale={state.time_scale} chipTimeS={state.chip_time_s} send={(time_scale) => send({ time_scale })} />
      <Divider label="Faults" labelPosition="left" />
      {(
        [
          ["silence", "Silent: answers are lost"],
          ["unplugged", "Unplugged: the link is gone"],
        ] as const
      ).map(([name, label]) => (
        <Switch
          key={name}
          size="sm"
          label={label}
          checked={faults[name]}
          onChange={(event) => send({ faults: { [name]: event.currentTarget.checked } })}
        />
      ))}
      <div className={classes.pairGrid}>
        <NumberField
          label="Bit error rate"
          value={faults.bit_error_rate}
          min={0}
          max={1}
          step={0.001}
          onChange={(bit_error_rate) => send({ faults: { bit_error_rate } })}
        />
        <NumberField
          label="Bridges at"
          unit="°C"
          value={motor.temperature_c}
          min={-40}
          max={250}
          step={5}
          onChange={(temperature_c) => send({ motor: { temperature_c } })}
        />
      </div>
      <Divider label="Power" labelPosition="left" />
      <Button
        size="xs"
        variant="default"
        leftSection={<IconPower size={16} aria-hidden />}
        onClick={() => send({ power_cycle: true })}
        data-testid="power-cycle"
      >
        Power cycle
      </Button>
      <Text size="xs" c="dimmed">
        Resets the chip: its registers are as after power-on. Motor and stage stay where they are.
      </Text>
    </>
  );
}
