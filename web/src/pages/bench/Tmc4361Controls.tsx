import { Divider, Text } from "@mantine/core";
import { fixed } from "../../lib/format";
import classes from "./bench.module.css";
import { EmulatorTime, Faults, Power, SwitchRow } from "./EmulatorParts";
import { BridgesAt, EncoderOnShaft, MotorStage, Shaft, Supply } from "./MotorParts";
import type { Tmc4361Patch, Tmc4361State } from "./useEmulator";

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

interface Props {
  state: Tmc4361State;
  send: (patch: Tmc4361Patch) => void;
}

/** The world of an emulated TMC4361: what pulls at its shaft, its encoder, stage and pins; and how the rotor is. */
export function Tmc4361Controls({ state, send }: Props) {
  const { encoder } = state;
  return (
    <>
      <Shaft world={state} send={send}>
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
      <div className={classes.fieldset}>
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
