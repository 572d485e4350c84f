import { Button, Group, Select } from "@mantine/core";
import { IconDownload } from "@tabler/icons-react";
import { Card } from "../../../lib/Card";
import { compact, withUnit } from "../../../lib/format";
import { type AxisScale, fromSteps, symbolOf, toSteps, unitsFor } from "../../../lib/units";
import { labelOf, type Model, type RampDesign } from "./design";
import { ParameterRow } from "./ParameterRow";

interface Props {
  model: Model;
  design: RampDesign;
  onChange: (change: Partial<RampDesign>) => void;
  scale: AxisScale;
  driverMicrosteps: number;
  units: { velocity: string; acceleration: string };
  onUnits: (units: { velocity: string; acceleration: string }) => void;
  /** limits of a_max for braking, as the calculator gave them */
  limits: { lower: number; upper: number } | null;
  /** null where there is no chip to read */
  onRead: (() => void) | null;
  reading: boolean;
}

const MAX = 2047;

function UnitChoice(props: { label: string; units: string[]; value: string; onChange: (unit: string) => void }) {
  return (
    <Select
      aria-label={props.label}
      w={84}
      data={props.units.map((unit) => ({ value: unit, label: symbolOf(unit) }))}
      value={props.value}
      comboboxProps={{ width: "max-content" }}
      onChange={(unit) => unit && props.onChange(unit)}
    />
  );
}

/** The registers of the ramp generator, in chip units and in the units of the axis. */
export function Parameters(props: Props) {
  const { model, design, onChange, scale, units, onUnits, limits } = props;
  const velocityUnits = unitsFor("velocity", scale).filter((unit) => unit !== "chip");
  const accelerationUnits = unitsFor("acceleration", scale).filter((unit) => unit !== "chip");
  const velocityUnit = velocityUnits.includes(units.velocity) ? units.velocity : "pps";
  const accelerationUnit = accelerationUnits.includes(units.acceleration) ? units.acceleration : "pps2";

  const physical = (key: "v_min" | "v_max" | "a_max") => {
    const motion = key === "a_max" ? "acceleration" : "velocity";
    const unit = motion === "velocity" ? velocityUnit : accelerationUnit;
    const inUnit = (chip: number) => fromSteps(toSteps(chip, "chip", scale, motion), unit, scale, motion);
    return {
      value: inUnit(design[key]),
      unit,
      max: inUnit(MAX),
      onChange: (typed: number) => {
        const chip = fromSteps(toSteps(typed, unit, scale, motion), "chip", scale, motion);
        onChange({ [key]: Math.min(MAX, Math.max(0, Math.round(chip))) });
      },
    };
  };

  const others = (key: "v_max" | "a_max") => {
    const motion = key === "a_max" ? "acceleration" : "velocity";
    const steps = toSteps(design[key], "chip", scale, motion);
    const wanted = motion === "velocity" ? ["pps", "rpm", "mm_per_s"] : ["pps2", "rad_per_s2", "mm_per_s2"];
    const all = motion === "velocity" ? velocityUnits : accelerationUnits;
    return (
      <span className="inline wrap gap-8 dim">
        {wanted
          .filter((unit) => all.includes(unit))
          .map((unit) => (
            <span key={unit} className="num">
              {withUnit(fromSteps(steps, unit, scale, motion), unit)}
            </span>
          ))}
      </span>
    );
  };

  const name = (key: keyof RampDesign) => labelOf(model, key);
  const perStep = (chip: number, motion: "velocity" | "acceleration") => toSteps(chip, "chip", scale, motion);
  const outside =
    limits && design.a_max > 0 && design.a_max < limits.lower
      ? `below ${limits.lower}: braking would need more than 2¹⁹ steps, the motor may oscillate around the target`
      : limits && design.a_max > limits.upper
        ? limits.upper < 1
          ? "no acceleration has a p that fits the register at these dividers"
          : `above ${limits.upper}: its p does not fit the register, the motor may oscillate around the target`
        : null;
  const limited = limits !== null && (limits.lower > 1 || limits.upper < MAX);

  return (
    <Card
      title="Registers"
      note={<span>clock {compact(scale.clockHz / 1e6, 4, "MHz")}</span>}
      actions={
        <Group gap={6}>
          <UnitChoice
            label="Unit of velocities"
            units={velocityUnits}
            value={velocityUnit}
            onChange={(velocity) => onUnits({ velocity, acceleration: accelerationUnit })}
          />
          <UnitChoice
            label="Unit of accelerations"
            units={accelerationUnits}
            value={accelerationUnit}
            onChange={(acceleration) => onUnits({ velocity: velocityUnit, acceleration })}
          />
          <Button
            variant="default"
            leftSection={<IconDownload size={14} aria-hidden />}
            disabled={props.onRead === null}
            loading={props.reading}
            onClick={() => props.onRead?.()}
          >
            Read from chip
          </Button>
        </Group>
      }
    >
      <div className="grid gap-8">
        <ParameterRow
          label={name("v_min")}
          title="velocity at which the motor may stop at once"
          value={design.v_min}
          max={MAX}
          onChange={(v_min) => onChange({ v_min })}
          physical={physical("v_min")}
        />
        <ParameterRow
          label={name("v_max")}
          title="highest velocity"
          value={design.v_max}
          max={MAX}
          onChange={(v_max) => onChange({ v_max })}
          physical={physical("v_max")}
          below={others("v_max")}
        />
        <ParameterRow
          label={name("a_max")}
          title="acceleration"
          value={design.a_max}
          max={MAX}
          onChange={(a_max) => onChange({ a_max })}
          physical={physical("a_max")}
          {...(limited ? { allowed: [limits.lower > 1 ? limits.lower : 0, limits.upper] as const } : {})}
          below={
            <>
              {others("a_max")}
              <span className={outside ? "m-0 caution text-12" : "hint m-0"}>
                {outside ??
                  (limited
                    ? `allowed here: ${limits.lower} to ${Math.min(MAX, limits.upper)}`
                    : "no limits at these dividers")}
              </span>
            </>
          }
        />
        <ParameterRow
          label={name("pulse_div")}
          title="divider of the pulse clock: the scale of velocities"
          value={design.pulse_div}
          max={13}
          onChange={(pulse_div) => onChange({ pulse_div })}
          meaning={`1 = ${withUnit(fromSteps(perStep(1, "velocity"), velocityUnit, scale, "velocity"), velocityUnit)}`}
        />
        <ParameterRow
          label={name("ramp_div")}
          title="divider of the ramp clock: the scale of accelerations"
          value={design.ramp_div}
          max={13}
          onChange={(ramp_div) => onChange({ ramp_div })}
          meaning={`1 = ${withUnit(
            fromSteps(perStep(1, "acceleration"), accelerationUnit, scale, "acceleration"),
            accelerationUnit,
          )}`}
        />
        {design.usrs !== null ? (
          <ParameterRow
            label="usrs"
            title="microstep resolution"
            value={design.usrs}
            max={6}
            onChange={(usrs) => onChange({ usrs })}
            meaning={design.usrs === 0 ? "full steps" : `${2 ** design.usrs} per full step`}
          />
        ) : (
          <p className="hint m-0">
            Microsteps are made by the step/direction driver: {props.driverMicrosteps} per full step (Connections).
          </p>
        )}
      </div>
    </Card>
  );
}
