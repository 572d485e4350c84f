import { NumberField } from "../../lib/NumberField";
import type { CoilForm } from "./coil";

/** A motor's coil, its current and its supply: what a chopper is calculated from. */
export function CoilFields({ form, change }: { form: CoilForm; change: (part: Partial<CoilForm>) => void }) {
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
    </>
  );
}
