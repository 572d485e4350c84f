import { Switch } from "@mantine/core";
import type { FieldsProps } from "../kind";
import { type Asked, Numbers } from "../Numbers";
import type { ResonanceForm } from "./form";

const NUMBERS: readonly Asked<ResonanceForm>[] = [
  { key: "velocityMinRps", label: "Slowest", min: 0.05, max: 20, unit: "turns/s" },
  {
    key: "velocityMaxRps",
    label: "Fastest",
    description: "twice the slowest at the least; as far as travel and acceleration let it get there",
    min: 0.1,
    max: 50,
    unit: "turns/s",
  },
  { key: "travelTurns", label: "Room to positions above", min: 1, max: 10_000, unit: "turns" },
  {
    key: "speeds",
    label: "Speeds",
    description: "more are made around what resonates",
    min: 8,
    max: 60,
    integer: true,
  },
  { key: "repeats", label: "Ways there and back at each", min: 1, max: 10, integer: true },
  {
    key: "currentPercent",
    label: "Compare with another current",
    description: "of the run current; empty: none",
    min: 20,
    max: 200,
    unit: "%",
    optional: true,
  },
];

/** Which speeds are looked at, with how much room, and which changes are compared. */
export function Fields({ form, change }: FieldsProps<ResonanceForm>) {
  return (
    <>
      <Numbers form={form} change={change} of={NUMBERS} />
      <Switch
        label="Compare with the other chopper (StealthChop, SpreadCycle)"
        checked={form.otherChopper}
        onChange={({ currentTarget }) => change({ otherChopper: currentTarget.checked })}
      />
    </>
  );
}
