import type { FieldsProps } from "../kind";
import { type Asked, Numbers } from "../Numbers";
import type { FirstLookForm } from "./form";

const NUMBERS: readonly Asked<FirstLookForm>[] = [
  { key: "turns", label: "Turn to either side", min: 0.1, max: 20, unit: "turns" },
  {
    key: "travelTurns",
    label: "Look for switches as far as",
    description: "0: not at all",
    min: 0,
    max: 10_000,
    unit: "turns",
  },
];

/** How far a first look turns, and how far it looks for switches. */
export function Fields({ form, change }: FieldsProps<FirstLookForm>) {
  return <Numbers form={form} change={change} of={NUMBERS} />;
}
