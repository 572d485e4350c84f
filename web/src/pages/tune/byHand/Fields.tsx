import { useState } from "react";
import { NumberField } from "../../../lib/NumberField";
import { QuantityField } from "../../../lib/QuantityField";
import type { FieldsProps } from "../kind";
import type { ScoredMoveForm } from "./form";
import { Watch } from "./Watch";

/** The move, how often, and when it is over. */
export function Fields({ form, change, scale, axis }: FieldsProps<ScoredMoveForm>) {
  const [unit, setUnit] = useState("rev");
  return (
    <>
      <QuantityField
        label="Move: there and back"
        motion="position"
        scale={scale}
        value={form.distance}
        unit={unit}
        onUnit={setUnit}
        onChange={(distance) => change({ distance })}
      />
      <NumberField
        label="Times"
        value={form.repeats}
        min={1}
        max={20}
        integer
        onChange={(repeats) => change({ repeats })}
      />
      <NumberField
        label="Over when the encoder stays within"
        value={form.bandFullsteps}
        min={0.01}
        max={20}
        unit="full steps"
        onChange={(bandFullsteps) => change({ bandFullsteps })}
      />
      <Watch device={axis.device} axis={axis.index} />
    </>
  );
}
