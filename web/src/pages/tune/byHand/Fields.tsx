import { DistanceField } from "../DistanceField";
import type { FieldsProps } from "../kind";
import { type Asked, Numbers } from "../Numbers";
import type { ScoredMoveForm } from "./form";
import { Watch } from "./Watch";

const NUMBERS: readonly Asked<ScoredMoveForm>[] = [
  { key: "repeats", label: "Times", min: 1, max: 20, integer: true },
  { key: "bandFullsteps", label: "Over when the encoder stays within", min: 0.01, max: 20, unit: "full steps" },
];

/** The move, how often, and when it is over. */
export function Fields({ form, change, scale, axis }: FieldsProps<ScoredMoveForm>) {
  return (
    <>
      <DistanceField form={form} change={change} scale={scale} label="Move: there and back" />
      <Numbers form={form} change={change} of={NUMBERS} />
      <Watch device={axis.device} axis={axis.index} />
    </>
  );
}
