import { TextInput } from "@mantine/core";
import { NumberField } from "../../../lib/NumberField";
import { CoilFields } from "../CoilFields";
import type { FieldsProps } from "../kind";
import { speedsOf } from "../stallguard/form";
import type { ChopperForm } from "./form";

/** The coil and its supply, at which speeds it is to be calm, and how much is tried. */
export function Fields({ form, change }: FieldsProps<ChopperForm>) {
  return (
    <>
      <CoilFields form={form} change={change} />
      <TextInput
        label="Calm at speeds of"
        description="turns of the motor a second"
        value={form.speeds}
        error={speedsOf(form.speeds).length > 0 ? undefined : "one number at least"}
        onChange={({ currentTarget }) => change({ speeds: currentTarget.value })}
      />
      <NumberField
        label="No chopper slower than"
        description="by an estimate: a slower one is heard"
        value={form.lowestKhz}
        min={5}
        max={50}
        unit="kHz"
        onChange={(lowestKhz) => change({ lowestKhz })}
      />
      <NumberField
        label="Settings that are tried"
        value={form.trials}
        min={2}
        max={500}
        integer
        onChange={(trials) => change({ trials })}
      />
    </>
  );
}
