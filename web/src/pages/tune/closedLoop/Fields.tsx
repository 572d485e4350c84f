import { Switch } from "@mantine/core";
import type { FieldsProps } from "../kind";
import { type Asked, Numbers } from "../Numbers";
import type { ClosedLoopForm } from "./form";

const NUMBERS: readonly Asked<ClosedLoopForm>[] = [
  {
    key: "phaseMarginDeg",
    label: "Phase margin",
    description: "less: faster, and more overshoot",
    min: 30,
    max: 80,
    unit: "°",
  },
  {
    key: "gainMargin",
    label: "Gain margin",
    description: "times more gain before it oscillates; 2 is 6 dB",
    min: 1.3,
    max: 10,
  },
  { key: "stepFullsteps", label: "Step", min: 0.5, max: 50, unit: "full steps" },
];

/** Which margins the loop shall have, and the steps by which it is shown. */
export function Fields({ form, change }: FieldsProps<ClosedLoopForm>) {
  return (
    <>
      <Numbers form={form} change={change} of={NUMBERS} />
      <Switch
        label="Leave the new gains set, and the loop on, where they do as asked"
        checked={form.keep}
        onChange={({ currentTarget }) => change({ keep: currentTarget.checked })}
      />
    </>
  );
}
