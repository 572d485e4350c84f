import { TextInput } from "@mantine/core";
import { NumberField } from "../../../lib/NumberField";
import type { FieldsProps } from "../kind";
import { speedsOf } from "../stallguard/form";
import type { ChopperForm } from "./form";

/** The coil and its supply, at which speeds it is to be calm, and how much is tried. */
export function Fields({ form, change }: FieldsProps<ChopperForm>) {
  return (
    <>
      <NumberField
        label="Resistance of one coil"
        description="by the motor's data sheet"
        value={form.resistanceOhm}
        min={0.01}
        max={200}
        unit="Ω"
        onChange={(resistanceOhm) => change({ resistanceOhm })}
      />
      <NumberField
        label="Inductance of one coil"
        value={form.inductanceMh}
        min={0.01}
        max={500}
        unit="mH"
        onChange={(inductanceMh) => change({ inductanceMh })}
      />
      <NumberField
        label="Run current as it is set now, RMS of one coil"
        value={form.runCurrentA}
        min={0.01}
        max={50}
        unit="A"
        onChange={(runCurrentA) => change({ runCurrentA })}
      />
      <NumberField
        label="Supply of the motor"
        value={form.supplyV}
        min={1}
        max={100}
        unit="V"
        onChange={(supplyV) => change({ supplyV })}
      />
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
