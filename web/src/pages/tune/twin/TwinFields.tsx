import { Autocomplete, Button, Switch, Text } from "@mantine/core";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { useEffect } from "react";
import { api } from "../../../api/client";
import { NumberField } from "../../../lib/NumberField";
import { useSessionKept } from "../../../lib/useKept";
import { BEGIN, type Progress, progressKey } from "../../firstRun/steps";
import type { FieldsProps } from "../kind";
import { asIdentified, isTried, named, type TwinForm } from "./form";
import { useIdentified } from "./useIdentified";

const SHOWN = 20;

interface Props {
  form: TwinForm;
  change: (form: TwinForm) => void;
  axis: FieldsProps<never>["axis"];
}

/** Whether a twin is tried first, and which motor it has: by its name, as identified, or as typed. */
export function TwinFields({ form, change, axis }: Props) {
  const tried = isTried(form);
  const motor = (part: Partial<TwinForm["motor"]>) => change({ ...form, motor: { ...form.motor, ...part } });
  return (
    <>
      <MotorName form={form} change={change} axis={axis} />
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
        </>
      )}
    </>
  );
}

/** A motor of the data base, found as its name is typed; the one of the first run by itself. */
function MotorName({ form, change, axis }: Props) {
  const [progress] = useSessionKept<Progress>(progressKey(axis.device, axis.index), BEGIN);
  const asked = progress.motor?.name ?? "";
  const text = form.typed ?? asked;
  const found = useQuery({
    queryKey: ["motors", text],
    queryFn: () => api.GET("/api/v1/motors", { query: { search: text, limit: SHOWN } }),
    placeholderData: keepPreviousData,
    retry: false,
  });
  const motors = found.data?.motors.filter(({ holding_torque_nm: torque }) => torque !== null) ?? [];
  // however the name came here, and whenever the list that has it: typed, pasted, chosen, or asked in the first run
  const meant = form.name === text ? undefined : motors.find(({ name }) => name === text);
  const known = meant && named(form, meant);
  useEffect(() => {
    if (known) change(known);
  });
  return (
    <Autocomplete
      label="Motor"
      description="of the data base, as its plate names it; for a twin"
      placeholder="17HS, 42sth48 …"
      data={motors.map(({ name }) => name)}
      filter={({ options }) => options}
      value={text}
      onChange={(name) => change({ ...form, typed: name, name: "" })}
      limit={SHOWN}
      maxDropdownHeight={260}
    />
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
