import { NativeSelect, Switch, TextInput } from "@mantine/core";
import { symbolOf, toSteps, unitsFor } from "../../../lib/units";
import { DistanceField } from "../DistanceField";
import type { FieldsProps } from "../kind";
import { MotorField } from "../motor/MotorField";
import { type Asked, Numbers } from "../Numbers";
import { SeenByField } from "../SeenByField";
import { named } from "../twin/form";
import { TwinFields } from "../twin/TwinFields";
import { type FastestMoveForm, furtherOf, type Sampler, type Shape, shapesOf } from "./form";

const NUMBERS: readonly Asked<FastestMoveForm>[] = [
  { key: "marginPercent", label: "Margin of speed and acceleration", min: 0, max: 100, unit: "%" },
  { key: "trials", label: "Settings tried at most", min: 1, max: 1000, integer: true },
  {
    key: "lossPercent",
    label: "Moves that may lose a step, at most",
    description: "1 % takes 299 moves to show; empty: what ten pairs show",
    min: 0.1,
    max: 20,
    unit: "%",
    optional: true,
  },
  {
    key: "velocityMaxPps",
    label: "Never faster than",
    description: "empty: the soft limit, else ten times as now",
    min: 1,
    unit: "pps",
    optional: true,
  },
  {
    key: "accelerationMaxPps2",
    label: "Never steeper than",
    description: "empty: the same",
    min: 1,
    unit: "pps^2",
    optional: true,
  },
];

const BOUND: readonly Asked<FastestMoveForm>[] = [
  {
    key: "deviationMax",
    label: "Never more off under way than",
    description: "the fastest that keeps to it; empty: a middle way of both",
    min: 0.001,
    unit: "full steps",
    optional: true,
  },
];

const SAMPLERS: readonly { value: Sampler; label: string }[] = [
  { value: "", label: "the usual sampler" },
  { value: "tpe", label: "TPE" },
  { value: "cmaes", label: "CMA-ES" },
  { value: "nsga2", label: "NSGA-II" },
];

/** The move, what it may cost, its limits, and what is known of the motor for a twin. */
export function Fields({ form, change, scale, axis, can }: FieldsProps<FastestMoveForm>) {
  const both = form.quiet && form.seenBy === "encoder";
  const shapes = shapesOf(can);
  return (
    <>
      <DistanceField form={form} change={change} scale={scale} label="Distance" />
      <FurtherField form={form} change={change} scale={scale} />
      <SeenByField form={form} change={change} />
      {shapes.length > 0 && (
        <NativeSelect
          label="Shape of the ramp"
          data={shapes}
          value={form.shape ?? ""}
          onChange={({ currentTarget }) => change({ shape: (currentTarget.value || null) as Shape | null })}
        />
      )}
      <Numbers form={form} change={change} of={NUMBERS} />
      {form.seenBy === "encoder" && (
        <>
          <MotorField
            axis={axis}
            choice={form.twin}
            description="of the data base, as its plate names it; for a twin"
            usable={({ holding_torque_nm }) => holding_torque_nm !== null}
            onType={(choice) => change({ twin: { ...form.twin, ...choice } })}
            onMotor={(motor) => change({ twin: named(form.twin, motor) })}
          />
          <TwinFields form={form.twin} change={(twin) => change({ twin })} axis={axis} />
          <Switch
            label="Quiet under way too"
            checked={form.quiet}
            onChange={({ currentTarget }) => change({ quiet: currentTarget.checked })}
          />
          {form.quiet && <Numbers form={form} change={change} of={BOUND} />}
        </>
      )}
      <NativeSelect
        label="Settings are asked of"
        data={both ? SAMPLERS.filter(({ value }) => value !== "cmaes") : SAMPLERS}
        value={both && form.sampler === "cmaes" ? "" : form.sampler}
        onChange={({ currentTarget }) => change({ sampler: currentTarget.value as Sampler })}
      />
    </>
  );
}

/** More distances of each run, all typed in one unit. */
function FurtherField({ form, change, scale }: Pick<FieldsProps<FastestMoveForm>, "form" | "change" | "scale">) {
  const unit = unitsFor("position", scale).includes("rev") ? "rev" : "microsteps";
  const type = (further: string) =>
    change({ further, distances: (furtherOf(further) ?? []).map((each) => toSteps(each, unit, scale, "position")) });
  return (
    <TextInput
      style={{ gridColumn: "1 / -1" }}
      label="Further distances"
      description={`${symbolOf(unit)}, eight at most: each run moves by all of them, and their times are added up; empty: none`}
      value={form.further}
      error={furtherOf(form.further) === null ? "numbers that are not 0, eight at most" : undefined}
      onChange={({ currentTarget }) => type(currentTarget.value)}
    />
  );
}
