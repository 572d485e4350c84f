import { Divider, Text } from "@mantine/core";
import type { Schemas } from "../../api/client";
import { fixed } from "../../lib/format";
import { EmulatorTime, Faults, Power, SwitchRow } from "../../pages/bench/EmulatorParts";
import { BridgesAt, EncoderOnShaft, MotorStage, Shaft, Supply } from "../../pages/bench/MotorParts";
import type { ControlsProps } from "../family";

type Tmc4361State = Schemas["Tmc4361State"];
type Tmc4361Patch = Schemas["Tmc4361Patch"];

const SWITCHES = [
  ["left", "STOPL"],
  ["home", "HOME_REF"],
  ["right", "STOPR"],
] as const;
const PINS = [
  ["start", "START"],
  ["freeze", "NFREEZE"],
] as const;
const FAULTS = [
  ["silence", "Silent: answers are lost"],
  ["unplugged", "Unplugged: the link is gone"],
] as const;

/** What the emulated driver behind is up to: it is set up over the chip, or as a device of its own. */
function DriverBehind({ driver }: { driver: Schemas["DriverBehindState"] }) {
  const { kind, follows, bridges, current_scale, load, flags } = driver;
  return (
    <>
      <Divider label={`Driver behind, ${kind.toUpperCase()}`} labelPosition="left" />
      <Text size="xs" data-testid="driver-behind">
        follows {follows}, bridges {bridges}, current scale <span className="num">{current_scale}</span>, load{" "}
        <span className="num">{load}</span>
        {flags.length > 0 && `, ${flags.join(" ")}`}
      </Text>
    </>
  );
}

/** What the SPI output sends by itself, as bits: a TMC23x, a TMC24x or a DAC takes its currents from there. */
function SpiOutput({ output }: { output: Schemas["SpiOutputState"] }) {
  return (
    <>
      <Divider label="SPI output" labelPosition="left" />
      <Text size="xs" data-testid="spi-output">
        {output.form}: <span className="num anywhere">{output.datagrams.join(", ")}</span>
      </Text>
    </>
  );
}

/** The plant of an emulated TMC4361: what pulls at its shaft, its encoder, stage and pins; and how the rotor is. */
export function Controls({ ...emulator }: ControlsProps) {
  const state = emulator.state as Tmc4361State;
  const send: (patch: Tmc4361Patch) => void = emulator.send;
  const { encoder } = state;
  return (
    <>
      <Shaft plant={state} send={send}>
        <Supply volts={state.supply_v} send={send} />
      </Shaft>
      <EncoderOnShaft
        slip={encoder.slip_fullsteps}
        what="The encoder"
        onSlip={() => send({ encoder: { slip_fullsteps: encoder.slip_fullsteps + 1 } })}
        eccentricityDeg={encoder.eccentricity_deg}
        onEccentricity={(eccentricity_deg) => send({ encoder: { eccentricity_deg } })}
      >
        <Text size="xs" c="dimmed">
          {encoder.kind}, <span className="num">{fixed(encoder.counts_per_turn)}</span> counts a turn
        </Text>
      </EncoderOnShaft>
      <MotorStage
        stage={state.stage}
        switches={state.switches}
        names={SWITCHES}
        onSwitch={(name, value) => send({ switches: { [name]: value } })}
        onPlaces={(stage) => send({ stage })}
      />
      <Divider label="Pins" labelPosition="left" />
      <div className="stack gap-4">
        {PINS.map(([name, label]) => (
          <SwitchRow
            key={name}
            label={label}
            of="the chip"
            forced={state.pins[name].forced}
            onChange={(value) => send({ pins: { [name]: value } })}
          />
        ))}
      </div>
      {state.driver && <DriverBehind driver={state.driver} />}
      {state.spi_output && <SpiOutput output={state.spi_output} />}
      <EmulatorTime state={state} send={send} />
      <Faults faults={state.faults} names={FAULTS} send={(faults) => send({ faults })}>
        <BridgesAt celsius={state.motor.temperature_c} send={send} />
      </Faults>
      <Power
        send={send}
        note="Resets the chip: its registers are as after power-on. Motor and stage stay where they are."
      />
    </>
  );
}
