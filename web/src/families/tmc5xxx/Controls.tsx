import { SegmentedControl, Switch, Text } from "@mantine/core";
import type { Schemas } from "../../api/client";
import { fixed } from "../../lib/format";
import { EmulatorTime, Faults, Power } from "../../pages/bench/EmulatorParts";
import { BridgesAt, EncoderOnShaft, MotorStage, Shaft, Supply } from "../../pages/bench/MotorParts";
import type { ControlsProps } from "../family";

type Tmc5xxxState = Schemas["Tmc5xxxState"];
type Tmc5xxxPatch = Schemas["Tmc5xxxPatch"];

const SWITCHES = [
  ["left", "REFL"],
  ["right", "REFR"],
] as const;
const FAULTS = [
  ["silence", "Silent: answers are lost"],
  ["unplugged", "Unplugged: the link is gone"],
] as const;

type AxisChange = Omit<NonNullable<Tmc5xxxPatch["axes"]>[number], "axis">;

/** The plant of an emulated TMC5xxx: what pulls at each shaft, its encoder and stage; the chip's supply and line. */
export function Controls({ device, axis, onAxis, ...emulator }: ControlsProps) {
  const state = emulator.state as Tmc5xxxState;
  const send: (patch: Tmc5xxxPatch) => void = emulator.send;
  const plant = state.axes.find((candidate) => candidate.axis === axis) ?? state.axes[0];
  if (plant === undefined) return null;
  const sendAxis = (change: AxisChange) => send({ axes: [{ axis: plant.axis, ...change }] });
  const { encoder } = plant;
  return (
    <>
      {state.axes.length > 1 && (
        <SegmentedControl
          fullWidth
          aria-label="Motor"
          data={state.axes.map(({ axis: index }) => ({
            value: String(index),
            label: `Motor of ${device.axes[index]?.name ?? index}`,
          }))}
          value={String(plant.axis)}
          onChange={(value) => onAxis(Number(value))}
        />
      )}
      {state.rigid && (
        <Text size="xs" c="dimmed">
          A rigid motor: the shaft follows the field exactly, whatever pulls at it.
        </Text>
      )}
      <Shaft plant={plant} send={sendAxis}>
        <Supply volts={state.supply_v} send={send} />
      </Shaft>
      {encoder && (
        <EncoderOnShaft
          slip={encoder.slip_fullsteps}
          what="The encoder"
          onSlip={() => sendAxis({ encoder: { slip_fullsteps: 1 } })}
        >
          <Text size="xs" c="dimmed">
            <span className="num">{fixed(encoder.counts_per_turn)}</span> counts a turn
            {encoder.connected ? "" : "; GCONF gives its pins to something else"}
          </Text>
        </EncoderOnShaft>
      )}
      <MotorStage
        stage={plant.stage}
        switches={plant.switches}
        names={SWITCHES}
        home={false}
        onSwitch={(name, value) => sendAxis({ switches: { [name]: value } })}
        onPlaces={(stage) => sendAxis({ stage })}
      />
      <EmulatorTime state={state} send={send} />
      <Faults faults={state.faults} names={FAULTS} send={(faults) => send({ faults })}>
        <BridgesAt celsius={plant.motor.temperature_c} send={sendAxis} />
      </Faults>
      <Switch
        size="sm"
        label="DRV_ENN high: bridges off"
        checked={state.pins.drv_enn}
        onChange={(event) => send({ pins: { drv_enn: event.currentTarget.checked } })}
      />
      <Power
        send={send}
        note={`Resets the chip: its registers are as after power-on. ${
          state.axes.length > 1 ? "Motors and stages stay" : "Motor and stage stay"
        } where they are.`}
      />
    </>
  );
}
