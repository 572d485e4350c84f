import { Button, Switch, Text } from "@mantine/core";
import { NumberField } from "../../../lib/NumberField";
import type { FieldsProps } from "../kind";
import { asIdentified, isTried, type TwinForm } from "./form";
import { useIdentified } from "./useIdentified";

interface Props {
  form: TwinForm;
  change: (form: TwinForm) => void;
  axis: FieldsProps<never>["axis"];
}

/** Whether a twin is tried first, and which motor it has: as it was named, as identified, or as typed. */
export function TwinFields({ form, change, axis }: Props) {
  const tried = isTried(form);
  const motor = (part: Partial<TwinForm["motor"]>) => change({ ...form, motor: { ...form.motor, ...part } });
  return (
    <>
      <FromStudy form={form} change={change} axis={axis} />
      <Switch
        label="Try on an emulated twin first"
        description={form.on === null && !tried ? "as soon as the motor is known" : undefined}
        checked={tried}
        onChange={({ currentTarget }) => change({ ...form, on: currentTarget.checked })}
      />
      {tried && (
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

/** Inertia, friction and encoder of the latest study of motor and machine. */
function FromStudy({ form, change, axis }: Props) {
  const latest = useIdentified(axis.device, axis.index);
  if (latest === null) return null;
  const changed = asIdentified(form, latest.found, latest.when);
  if (changed === null)
    return (
      <Text size="sm" className="dim">
        Motor and machine, {latest.when}: without the holding torque it could not tell the inertia that a twin takes.
      </Text>
    );
  return (
    <Button
      variant="default"
      size="compact-sm"
      aria-pressed={form.identified === latest.when}
      onClick={() => change(changed)}
    >
      Twin as identified on {latest.when}
    </Button>
  );
}
