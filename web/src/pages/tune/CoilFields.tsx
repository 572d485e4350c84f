import type { CoilForm } from "./coil";
import { type Asked, Numbers } from "./Numbers";

const NUMBERS: readonly Asked<CoilForm>[] = [
  {
    key: "resistanceOhm",
    label: "Resistance of one coil",
    description: "by the motor's data sheet",
    min: 0.01,
    max: 200,
    unit: "Ω",
  },
  { key: "inductanceMh", label: "Inductance of one coil", min: 0.01, max: 500, unit: "mH" },
  { key: "runCurrentA", label: "Run current as it is set now, RMS of one coil", min: 0.01, max: 50, unit: "A" },
  { key: "supplyV", label: "Supply of the motor", min: 1, max: 100, unit: "V" },
];

/** A motor's coil, its current and its supply: what a chopper is calculated from. */
export function CoilFields({ form, change }: { form: CoilForm; change: (part: Partial<CoilForm>) => void }) {
  return <Numbers form={form} change={change} of={NUMBERS} />;
}
