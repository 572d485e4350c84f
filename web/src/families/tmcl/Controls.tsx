import { Button, Divider, Switch } from "@mantine/core";
import { IconArrowBackUp } from "@tabler/icons-react";
import { useState } from "react";
import type { Schemas } from "../../api/client";
import { NumberField } from "../../lib/NumberField";
import { EmulatorTime, Faults, Power } from "../../pages/bench/EmulatorParts";
import { BridgesAt, EncoderOnShaft, MotorStage, Shaft, Supply } from "../../pages/bench/MotorParts";
import type { ControlsProps } from "../family";

type TmclState = Schemas["TmclState"];
type TmclPatch = Schemas["TmclPatch"];

const SWITCHES = [
  ["left", "Left"],
  ["home", "Home"],
  ["right", "Right"],
] as const;
const FAULTS = [
  ["silence", "Silent: answers are lost"],
  ["unplugged", "Unplugged: the line is gone"],
  ["undervoltage", "Undervoltage: bridges off"],
] as const;

/** The plant of an emulated module: what pulls at its shaft, its stage, its supply, its line; and how the rotor is. */
export function Controls({ ...emulator }: ControlsProps) {
  const state = emulator.state as TmclState;
  const send: (patch: TmclPatch) => void = emulator.send;
  const { faults, encoder } = state;
  return (
    <>
      <Shaft plant={state} send={send}>
        <Supply volts={state.supply_v} send={send} />
      </Shaft>
      <EncoderOnShaft
        slip={encoder.slip_fullsteps}
        what="The magnet"
        onSlip={() => send({ encoder: { slip_fullsteps: 1 } })}
        eccentricityDeg={encoder.eccentricity_deg}
        onEccentricity={(eccentricity_deg) => send({ encoder: { eccentricity_deg } })}
      />
      <MotorStage
        stage={state.stage}
        switches={state.switches}
        names={SWITCHES}
        onSwitch={(name, value) => send({ switches: { [name]: value } })}
        onPlaces={(stage) => send({ stage })}
      />
      <Inputs inputs={state.inputs} send={send} />
      <EmulatorTime state={state} send={send} />
      <Faults faults={faults} names={FAULTS} send={(change) => send({ faults: change })}>
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
        <BridgesAt celsius={state.motor.temperature_c} send={send} />
      </Faults>
      <Power send={send} note="A power cycle keeps what was stored in the EEPROM. Motor and stage stay where they are.">
        <FactoryDefault send={send} />
      </Power>
    </>
  );
}

/** What cannot be taken back is asked for twice. */
function FactoryDefault({ send }: { send: (patch: TmclPatch) => void }) {
  const [sure, setSure] = useState(false);
  return (
    <Button
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

/** What lies at the inputs of the connector: levels, the analog input, pulses of a generator on step and direction. */
function Inputs({ inputs, send }: { inputs: TmclState["inputs"]; send: (patch: TmclPatch) => void }) {
  const [pulses, setPulses] = useState(256);
  return (
    <>
      <Divider label="Inputs" labelPosition="left" />
      <div className="halves gap-6">
        {(["in1", "in2"] as const).map((name) => (
          <Switch
            key={name}
            size="sm"
            label={name.toUpperCase()}
            checked={inputs[name]}
            onChange={(event) => send({ inputs: { [name]: event.currentTarget.checked } })}
          />
        ))}
        <NumberField
          label="Analog, AIN0"
          description={`IN3 is ${inputs.in3 ? 1 : 0}`}
          integer
          value={inputs.analog}
          min={0}
          max={4095}
          onChange={(analog) => send({ inputs: { analog } })}
        />
        <NumberField
          label="Step pulses"
          description="count with AP 254 on"
          integer
          value={pulses}
          min={-(2 ** 24)}
          max={2 ** 24}
          onChange={setPulses}
        />
      </div>
      <Button variant="default" onClick={() => send({ step_dir: { pulses, rate_hz: 1000 } })}>
        Send pulses
      </Button>
    </>
  );
}
