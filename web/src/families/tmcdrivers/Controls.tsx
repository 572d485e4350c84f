import { Switch, Text } from "@mantine/core";
import type { Schemas } from "../../api/client";
import { NumberField } from "../../lib/NumberField";
import { EmulatorTime, Faults, Power } from "../../pages/bench/EmulatorParts";
import { BridgesAt, Shaft, Supply } from "../../pages/bench/MotorParts";
import type { ControlsProps } from "../family";

type DriverState = Schemas["TmcDriverState"];
type DriverPatch = Schemas["TmcDriverPatch"];

/** beyond what the clock of the chip lets it take the server refuses */
const STEP_HZ_MAX = 9e6;

const FAULTS = [
  ["silence", "Silent: answers are lost"],
  ["unplugged", "Unplugged: the link is gone"],
] as const;

/** The plant of an emulated driver: what pulls at the shaft, its supply, its pins and its line. */
export function Controls({ ...emulator }: ControlsProps) {
  const state = emulator.state as DriverState;
  const send: (patch: DriverPatch) => void = emulator.send;
  return (
    <>
      {state.rigid && (
        <Text size="xs" c="dimmed">
          A rigid motor: the shaft follows the field exactly, whatever pulls at it.
        </Text>
      )}
      <Shaft plant={state} send={send}>
        <Supply volts={state.supply_v} send={send} />
      </Shaft>
      <NumberField
        label="Steps at STEP"
        unit="1/s"
        value={state.pins.step_hz}
        min={-STEP_HZ_MAX}
        max={STEP_HZ_MAX}
        step={100}
        description="negative: DIR is high"
        onChange={(step_hz) => send({ pins: { step_hz } })}
      />
      {state.pins.vref_v != null && (
        <NumberField
          label="Voltage at VREF"
          unit="V"
          value={state.pins.vref_v}
          min={0}
          max={5}
          step={0.1}
          description="scales the current up to 2.5 V, while I_scale_analog is set"
          onChange={(vref_v) => send({ pins: { vref_v } })}
        />
      )}
      <Text size="xs" c="dimmed">
        DIAG is {state.pins.diag ? "active: a stall, or the driver has shut down" : "at rest"}.
        {state.pins.index != null && ` INDEX is ${state.pins.index ? "active" : "at rest"}.`}
      </Text>
      <EmulatorTime state={state} send={send} />
      <Faults faults={state.faults} names={FAULTS} send={(faults) => send({ faults })}>
        <BridgesAt celsius={state.motor.temperature_c} send={send} />
      </Faults>
      <Switch
        size="sm"
        label="ENN high: bridges off"
        checked={state.pins.enn}
        onChange={(event) => send({ pins: { enn: event.currentTarget.checked } })}
      />
      <Power send={send} note="Resets the chip: its registers are as after power-on. The motor stays where it is." />
    </>
  );
}
