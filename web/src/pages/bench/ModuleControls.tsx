import { Button, Divider, Group, Switch, Text } from "@mantine/core";
import { IconArrowBackUp, IconPower } from "@tabler/icons-react";
import { useState } from "react";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import classes from "./bench.module.css";
import { LoadSlider, StagePlacesFields, SwitchRow, TimeScale } from "./EmulatorParts";
import { RotorDial } from "./RotorDial";
import type { Pd42Patch, Pd42State } from "./useEmulator";

interface Props {
  state: Pd42State;
  send: (patch: Pd42Patch) => void;
}

/** The world of an emulated module: what pulls at its shaft, its stage, its supply, its line; and how the rotor is. */
export function ModuleControls({ state, send }: Props) {
  const { faults, stage, encoder, motor } = state;
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
          data-testid="supply"
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
        <SlipButton slip={encoder.slip_fullsteps} send={send} />
      </Group>
      <Divider label="Switches and stage" labelPosition="left" />
      <div className={classes.fieldset}>
        {(["left", "home", "right"] as const).map((name) => (
          <SwitchRow
            key={name}
            label={name === "home" ? "Home" : name === "left" ? "Left" : "Right"}
            of="the stage"
            forced={state.switches[name].forced}
            onChange={(value) => send({ switches: { [name]: value } })}
          />
        ))}
      </div>
      <StagePlacesFields stage={stage} send={(places) => send({ stage: places })} />
      <Divider label="Time" labelPosition="left" />
      <TimeScale scale={state.time_scale} chipTimeS={state.chip_time_s} send={(time_scale) => send({ time_scale })} />
      <Divider label="Faults" labelPosition="left" />
      {(
        [
          ["silence", "Silent: answers are lost"],
          ["unplugged", "Unplugged: the line is gone"],
          ["undervoltage", "Undervoltage: bridges off"],
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
          label="Half frames"
          value={faults.half_frame_rate}
          min={0}
          max={1}
          step={0.01}
          onChange={(half_frame_rate) => send({ faults: { half_frame_rate } })}
        />
        <NumberField
          label="Answers late by"
          unit="s"
          value={faults.late_reply_s}
          min={0}
          max={60}
          step={0.01}
          onChange={(late_reply_s) => send({ faults: { late_reply_s } })}
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
      <Group gap={6} grow wrap="nowrap">
        <Button
          size="xs"
          variant="default"
          leftSection={<IconPower size={16} aria-hidden />}
          onClick={() => send({ power_cycle: true })}
          data-testid="power-cycle"
        >
          Power cycle
        </Button>
        <FactoryDefault send={send} />
      </Group>
      <Text size="xs" c="dimmed">
        A power cycle keeps what was stored in the EEPROM. Motor and stage stay where they are.
      </Text>
    </>
  );
}

function SlipButton({ slip, send }: { slip: number; send: (patch: Pd42Patch) => void }) {
  return (
    <Button
      size="xs"
      variant="default"
      title={`The magnet turns on the shaft by one full step; ${fixed(slip, 1)} so far`}
      onClick={() => send({ encoder: { slip_fullsteps: 1 } })}
      data-testid="slip"
    >
      Slip 1 step
    </Button>
  );
}

/** What cannot be taken back is asked for twice. */
function FactoryDefault({ send }: { send: (patch: Pd42Patch) => void }) {
  const [sure, setSure] = useState(false);
  return (
    <Button
      size="xs"
      variant={sure ? "filled" : "default"}
      leftSection={<IconArrowBackUp size={16} aria-hidden />}
      onBlur={() => setSure(false)}
      onClick={() => {
        if (sure) send({ factory_default: true });
        setSure(!sure);
      }}
    >
      {sure ? "Erase all?" : "Factory"}
    </Button>
  );
}
