import { Switch } from "@mantine/core";
import type { FieldsProps } from "../kind";
import { type Asked, Numbers } from "../Numbers";
import type { MicrostepForm } from "./form";

const NUMBERS: readonly Asked<MicrostepForm>[] = [
  { key: "turns", label: "Each run", min: 1, max: 10, integer: true, unit: "turns" },
  {
    key: "velocityRps",
    label: "Speed",
    description: "so slow that the load follows four errors a full step",
    min: 0.002,
    max: 0.5,
    unit: "turns/s",
  },
  { key: "pairs", label: "Pairs of the proof", min: 6, max: 50, integer: true },
];

/** How far and how slowly the motor turns, how often it is proved, and whether a better table stays. */
export function Fields({ form, change }: FieldsProps<MicrostepForm>) {
  return (
    <>
      <Numbers form={form} change={change} of={NUMBERS} />
      <Switch
        label="Leave the new table set where it is shown to be better"
        checked={form.keep}
        onChange={({ currentTarget }) => change({ keep: currentTarget.checked })}
      />
    </>
  );
}
