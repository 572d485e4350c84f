import { Checkbox, Switch } from "@mantine/core";
import { NumberField } from "../../../lib/NumberField";
import { dateTimeOf } from "../../../lib/time";
import type { FieldsProps } from "../kind";
import { useStudies } from "../useStudies";
import { byItself, isTried, type TwinForm, takenFrom } from "./form";

interface Props {
  form: TwinForm;
  change: (form: TwinForm) => void;
  axis: FieldsProps<never>["axis"];
}

/** Whether a twin is tried first, and which motor it has: as it was named, as identified, or as typed. */
export function TwinFields({ form, change, axis }: Props) {
  const identified = useStudies().data?.studies.find(
    ({ device, axis: index, kind, state }) =>
      device === axis.device && index === axis.index && kind === "identification" && state === "done",
  );
  const known = identified !== undefined;
  const tried = isTried(form, known);
  const motor = (part: Partial<TwinForm["motor"]>) => change({ ...form, motor: { ...form.motor, ...part } });
  return (
    <>
      <Switch
        label="Try on an emulated twin first"
        description={form.on === null && !tried ? "as soon as the motor is known" : undefined}
        checked={tried}
        onChange={({ currentTarget: { checked } }) =>
          change(checked && known ? takenFrom(form, form.asIdentified) : { ...form, on: checked })
        }
      />
      {tried && identified && (
        <Checkbox
          label={`Twin as identified on ${dateTimeOf(identified.started_unix_s * 1000)}`}
          description="by Motor and machine, as far as that could tell"
          checked={form.asIdentified}
          onChange={({ currentTarget: { checked } }) => change(takenFrom(form, checked))}
        />
      )}
      {tried && !byItself(form) && (
        <>
          <NumberField
            label="Holding torque of the motor"
            value={form.motor.holding_torque_nm}
            min={0.001}
            max={50}
            unit="N m"
            onChange={(value) => motor({ holding_torque_nm: value })}
          />
          <NumberField
            label="Rated current of the motor"
            value={form.motor.rated_current_a}
            min={0.05}
            max={20}
            unit="A"
            onChange={(value) => motor({ rated_current_a: value })}
          />
          <NumberField
            label="Inertia of the load, at the motor"
            value={form.motor.load_inertia_kgm2}
            min={0}
            max={1}
            unit="kg m²"
            onChange={(value) => motor({ load_inertia_kgm2: value })}
          />
          <NumberField
            label="Motor supply of the twin"
            value={form.motor.supply_v}
            min={1}
            max={60}
            unit="V"
            onChange={(value) => motor({ supply_v: value })}
          />
        </>
      )}
    </>
  );
}
