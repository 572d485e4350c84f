import { Checkbox } from "@mantine/core";
import { DistanceField } from "../DistanceField";
import type { FieldsProps } from "../kind";
import { MotorField } from "../motor/MotorField";
import { RATED } from "../motor/motor";
import { type Asked, Numbers } from "../Numbers";
import { TwinFields } from "../twin/TwinFields";
import { type LeastCurrentForm, withMotor } from "./form";

const NUMBERS: readonly Asked<LeastCurrentForm>[] = [
  {
    key: "marginPercent",
    label: "Margin of current",
    description: "for a heavier load, a warm motor",
    min: 0,
    max: 60,
    unit: "%",
  },
  {
    key: "speedPercent",
    label: "Margin of speed",
    description: "for a supply that sags: tried as so much more speed; 0: not tried",
    min: 0,
    max: 100,
    unit: "%",
  },
  {
    key: "lossPercent",
    label: "Cycles that may lose a step, at most",
    description: "1 % takes 299 cycles to show, 5 % takes 59",
    min: 0.1,
    max: 20,
    unit: "%",
  },
  {
    key: "resistanceOhm",
    label: "Resistance of one coil",
    description: "empty: the saving is a share, not watts",
    min: 0.01,
    max: 200,
    unit: "Ω",
    optional: true,
  },
  {
    key: "runCurrentA",
    label: "Run current as it is set now, RMS of one coil",
    min: 0.01,
    max: 30,
    unit: "A",
    optional: true,
  },
];

/** The load cycle, the margin, how sure it has to be, and what watts are reckoned with. */
export function Fields({ form, change, scale, axis }: FieldsProps<LeastCurrentForm>) {
  return (
    <>
      <DistanceField form={form} change={change} scale={scale} label="Load cycle: there and back" />
      <MotorField
        axis={axis}
        choice={form.motor}
        description="of the data base, as its plate names it; for watts, and for a twin"
        onType={(motor) => change({ motor, twin: { ...form.twin, ...motor } })}
        onMotor={(motor, choice, typed) => change(withMotor(form, motor, choice, typed))}
        note={form.runCurrentA === null ? "" : RATED}
      />
      <Numbers form={form} change={change} of={NUMBERS} />
      <TwinFields form={form.twin} change={(twin) => change({ twin })} axis={axis} />
      <Checkbox
        label="CoolStep too"
        description="where the chip has it: less current where the load is small"
        checked={form.coolstep}
        onChange={(event) => change({ coolstep: event.currentTarget.checked })}
      />
    </>
  );
}
