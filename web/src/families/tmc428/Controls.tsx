import { Divider } from "@mantine/core";
import type { Schemas } from "../../api/client";
import { fixed } from "../../lib/format";
import { EmulatorTime, Faults, Power, SwitchRow } from "../../pages/bench/EmulatorParts";
import type { ControlsProps } from "../family";

type ChipState = Schemas["EmulatorState"];
type ChipPatch = Schemas["EmulatorPatch"];
type ChipAxis = ChipState["axes"][number];

const SWITCHES = [
  ["left", "Left"],
  ["reference", "Reference"],
  ["right", "Right"],
] as const;

const FAULTS = [
  ["silence", "Silent: frames get no answer"],
  ["unplugged", "Unplugged: the link is gone"],
] as const;

/** What acts on an emulated chip: switches, time, faults, power. */
export function Controls({ device, ...emulator }: ControlsProps) {
  const state = emulator.state as ChipState;
  const send: (patch: ChipPatch) => void = emulator.send;
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
      <EmulatorTime state={state} send={send} />
      <Faults faults={state.faults} names={FAULTS} send={(faults) => send({ faults })} />
      <Power
        send={send}
        note="Resets the chip: registers and RAM lose what was set. The carriages stay where they are."
      />
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
    <fieldset className="bare stack gap-4">
      <legend className="row between w-full p-0 text-13 bold">
        {name}
        <span className="num hint regular">{fixed(axis.position_fullsteps, 1)} full steps</span>
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
