import { Button, Divider, Group, Switch } from "@mantine/core";
import type { ReactNode } from "react";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { LoadSlider, type Places, StagePlacesFields, SwitchRow } from "./EmulatorParts";
import { RotorDial, type Truth } from "./RotorDial";

/** What every emulated motor tells of itself, whatever drives it. */
export interface MotorPlant {
  truth: Truth;
  motor: { connected: boolean; temperature_c: number; holding_torque_nm: number };
  load_torque_nm: number;
  friction: number;
  blocked: boolean;
}

/** What every emulated motor can be told. */
export interface MotorChange {
  motor?: { connected?: boolean; temperature_c?: number };
  load_torque_nm?: number;
  friction?: number;
  blocked?: boolean;
}

interface ShaftProps {
  plant: MotorPlant;
  send: (change: MotorChange) => void;
  /** beside the friction */
  children?: ReactNode;
}

/** How the rotor is, and what pulls at its shaft. */
export function Shaft({ plant, send, children }: ShaftProps) {
  // the slider goes a little beyond what the motor holds
  const most = Math.ceil(plant.motor.holding_torque_nm * 1200) / 1000;
  return (
    <>
      <RotorDial truth={plant.truth} />
      <Divider label="Shaft" labelPosition="left" />
      <LoadSlider value={plant.load_torque_nm} most={most} send={(load_torque_nm) => send({ load_torque_nm })} />
      <div className="halves gap-6">
        <NumberField
          label="Friction"
          unit="N·m"
          value={plant.friction}
          min={0}
          max={50}
          step={0.01}
          onChange={(friction) => send({ friction })}
        />
        {children}
      </div>
      <Switch
        size="sm"
        label="Shaft blocked"
        checked={plant.blocked}
        onChange={(event) => send({ blocked: event.currentTarget.checked })}
        data-testid="blocked"
      />
      <Switch
        size="sm"
        label="Motor plugged in"
        checked={plant.motor.connected}
        onChange={(event) => send({ motor: { connected: event.currentTarget.checked } })}
      />
    </>
  );
}

/** The motors' supply, beside the friction. */
export function Supply({ volts, send }: { volts: number; send: (change: { supply_v: number }) => void }) {
  return (
    <NumberField
      label="Supply"
      unit="V"
      value={volts}
      min={0}
      max={60}
      step={1}
      onChange={(supply_v) => send({ supply_v })}
      data-testid="supply"
    />
  );
}

/** How warm the bridges are, among the faults. */
export function BridgesAt({ celsius, send }: { celsius: number; send: (change: MotorChange) => void }) {
  return (
    <NumberField
      label="Bridges at"
      unit="°C"
      value={celsius}
      min={-40}
      max={250}
      step={5}
      onChange={(temperature_c) => send({ motor: { temperature_c } })}
    />
  );
}

interface EncoderProps {
  /** so far [full steps] */
  slip: number;
  what: string;
  /** lets it slip by one more */
  onSlip: () => void;
  eccentricityDeg?: number;
  onEccentricity?: (degrees: number) => void;
  /** what is to be said of it */
  children?: ReactNode;
}

/** What can be wrong with the encoder on a shaft. */
export function EncoderOnShaft({ slip, what, onSlip, eccentricityDeg, onEccentricity, children }: EncoderProps) {
  return (
    <>
      <Divider label="Encoder" labelPosition="left" />
      {children}
      <Group gap={6} wrap="nowrap" align="flex-end">
        {eccentricityDeg !== undefined && onEccentricity && (
          <NumberField
            label="Eccentricity"
            unit="°"
            value={eccentricityDeg}
            min={0}
            max={10}
            step={0.1}
            flex={1}
            onChange={onEccentricity}
          />
        )}
        <Button
          variant="default"
          title={`${what} turns on the shaft by one full step; ${fixed(slip, 1)} so far`}
          onClick={onSlip}
          data-testid="slip"
        >
          Slip 1 step
        </Button>
      </Group>
    </>
  );
}

interface StageProps<Name extends string> {
  stage: Places;
  switches: Readonly<Record<Name, { forced: boolean | null }>>;
  /** the switches that there are, as their inputs are called */
  names: readonly (readonly [name: Name, label: string])[];
  /** no home switch: its places are of no use */
  home?: boolean;
  onSwitch: (name: Name, value: boolean | "auto") => void;
  onPlaces: (places: Partial<Places>) => void;
}

/** The stage on a motor: where its switches stand, and what holds them. */
export function MotorStage<Name extends string>({
  stage,
  switches,
  names,
  home = true,
  onSwitch,
  onPlaces,
}: StageProps<Name>) {
  return (
    <>
      <Divider label="Switches and stage" labelPosition="left" />
      <div className="stack gap-4">
        {names.map(([name, label]) => (
          <SwitchRow
            key={name}
            label={label}
            of="the stage"
            forced={switches[name].forced}
            onChange={(value) => onSwitch(name, value)}
          />
        ))}
      </div>
      <StagePlacesFields stage={stage} home={home} send={onPlaces} />
    </>
  );
}
