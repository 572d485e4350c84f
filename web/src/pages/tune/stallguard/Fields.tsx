import { Checkbox, TextInput } from "@mantine/core";
import { Choice } from "../../../lib/Choice";
import { NumberField } from "../../../lib/NumberField";
import type { FieldsProps } from "../kind";
import { type Asked, Numbers } from "../Numbers";
import { type StallGuardForm, speedsOf } from "./form";

const SIDES = [
  { value: "left", label: "left" },
  { value: "right", label: "right" },
];

const NUMBERS: readonly Asked<StallGuardForm>[] = [
  {
    key: "freeRuns",
    label: "Free runs of the proof",
    description: "299 without a false stall show less than 1 %",
    min: 20,
    max: 3000,
    integer: true,
  },
  { key: "stops", label: "Runs into the stop of the proof", min: 10, max: 1000, integer: true },
];

/** Where the stop is, at which speeds, and how many runs prove it. */
export function Fields({ form, change }: FieldsProps<StallGuardForm>) {
  return (
    <>
      <Choice
        label="The stop is to the"
        data={SIDES}
        value={form.side}
        onChange={(side) => change({ side: side as StallGuardForm["side"] })}
      />
      <NumberField
        label="From here no further than"
        value={form.withinFullsteps}
        min={50}
        max={1e6}
        unit="full steps"
        onChange={(withinFullsteps) => change({ withinFullsteps })}
      />
      <TextInput
        label="At speeds of"
        description="turns of the motor a second"
        value={form.speeds}
        error={speedsOf(form.speeds).length > 0 ? undefined : "one number at least"}
        onChange={({ currentTarget }) => change({ speeds: currentTarget.value })}
      />
      <Numbers form={form} change={change} of={NUMBERS} />
      <Checkbox
        label="Where one threshold does not do it at all speeds, prove one for each of the others"
        description="the plan tells what that costs more"
        checked={form.eachSpeed}
        onChange={({ currentTarget }) => change({ eachSpeed: currentTarget.checked })}
      />
      <Checkbox
        label="A hard stop is there, and the motor may run into it"
        checked={form.confirmed}
        onChange={({ currentTarget }) => change({ confirmed: currentTarget.checked })}
      />
    </>
  );
}
