import { TextInput } from "@mantine/core";
import { CoilFields } from "../CoilFields";
import type { FieldsProps } from "../kind";
import { type Asked, Numbers } from "../Numbers";
import { speedsOf } from "../stallguard/form";
import type { ChopperForm } from "./form";

const NUMBERS: readonly Asked<ChopperForm>[] = [
  {
    key: "lowestKhz",
    label: "No chopper slower than",
    description: "by an estimate: a slower one is heard",
    min: 5,
    max: 50,
    unit: "kHz",
  },
  { key: "trials", label: "Settings that are tried", min: 2, max: 500, integer: true },
];

/** The coil and its supply, at which speeds it is to be calm, and how much is tried. */
export function Fields({ form, change, axis }: FieldsProps<ChopperForm>) {
  return (
    <>
      <CoilFields form={form} change={change} axis={axis} />
      <TextInput
        label="Calm at speeds of"
        description="turns of the motor a second"
        value={form.speeds}
        error={speedsOf(form.speeds).length > 0 ? undefined : "one number at least"}
        onChange={({ currentTarget }) => change({ speeds: currentTarget.value })}
      />
      <Numbers form={form} change={change} of={NUMBERS} />
    </>
  );
}
