import { Divider, SegmentedControl, Switch } from "@mantine/core";
import type { Schemas } from "../../api/client";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { EmulatorTime, Faults, Power, SwitchRow } from "../../pages/bench/EmulatorParts";
import { BridgesAt, type MotorChange, Shaft, Supply } from "../../pages/bench/MotorParts";
import type { ControlsProps } from "../family";

type ChipState = Schemas["EmulatorState"];
type ChipPatch = Schemas["EmulatorPatch"];
type ChipAxis = ChipState["axes"][number];
type ChainDriver = Schemas["DriverState"];
type DriverChange = Omit<NonNullable<ChipPatch["drivers"]>[number], "axis">;

const SWITCHES = [
  ["left", "Left"],
  ["reference", "Reference"],
  ["right", "Right"],
] as const;

/** What a TMC236 can be made to report, by the bit of its status (DS-TMC428 9.1). */
const REPORTS = [
  ["Too hot (OT)", 1 << 7],
  ["Hot (OTPW)", 1 << 6],
  ["Too little supply voltage (UV)", 1 << 5],
  ["Overcurrent, high side (OCHS)", 1 << 4],
  ["Overcurrent, coil A (OCA)", 1 << 0],
  ["Overcurrent, coil B (OCB)", 1 << 1],
  ["Coil A open (OLA)", 1 << 2],
  ["Coil B open (OLB)", 1 << 3],
] as const;
/** StallGuard's load value of a TMC246 or TMC249, 0..7: the less, the more load. */
const LOAD = 9;

const FAULTS = [
  ["silence", "Silent: frames get no answer"],
  ["unplugged", "Unplugged: the link is gone"],
] as const;

/** What acts on an emulated chip: switches, time, faults, power. */
export function Controls({ device, axis: chosen, onAxis, ...emulator }: ControlsProps) {
  const state = emulator.state as ChipState;
  const send: (patch: ChipPatch) => void = emulator.send;
  const drivers = state.driver_chain?.drivers ?? [];
  const driver = drivers.find(({ driver: index }) => index === chosen) ?? drivers[0];
  return (
    <>
      {driver !== undefined && (
        <>
          <Divider label="Drivers of the chain" labelPosition="left" />
          <SegmentedControl
            fullWidth
            aria-label="Driver of the chain"
            data={drivers.map(({ driver: index }) => ({
              value: String(index),
              label: `Driver of ${device.axes[index]?.name ?? index}`,
            }))}
            value={String(driver.driver)}
            onChange={(value) => onAxis(Number(value))}
          />
          <OfDriver driver={driver} send={(change) => send({ drivers: [{ axis: driver.driver, ...change }] })} />
        </>
      )}
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

interface DriverProps {
  driver: ChainDriver;
  send: (change: DriverChange) => void;
}

/** One driver of the chain: its motor, or without one of its own what it reports. */
function OfDriver({ driver, send }: DriverProps) {
  const { motor, truth, load, status } = driver;
  if (!motor || !truth || !load)
    return (
      <div className="stack gap-4" data-testid="driver-reports">
        {REPORTS.map(([label, bit]) => (
          <Switch
            key={label}
            size="sm"
            label={label}
            checked={(status & bit) !== 0}
            onChange={(event) => send({ status: event.currentTarget.checked ? status | bit : status & ~bit })}
          />
        ))}
        <NumberField
          label="Load value (LD2 LD1 LD0)"
          value={(status >> LOAD) & 7}
          min={0}
          max={7}
          step={1}
          onChange={(load) => send({ status: (status & ~(7 << LOAD)) | (load << LOAD) })}
        />
      </div>
    );
  const sendMotor = (change: MotorChange) => send(change);
  return (
    <>
      <Shaft plant={{ motor, truth, ...load }} send={sendMotor}>
        <Supply volts={load.supply_v} send={send} />
      </Shaft>
      <BridgesAt celsius={motor.temperature_c} send={sendMotor} />
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
