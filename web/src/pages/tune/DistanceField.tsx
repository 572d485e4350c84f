import { useState } from "react";
import { QuantityField } from "../../lib/QuantityField";
import type { FieldsProps } from "./kind";

type Props = Pick<FieldsProps<{ distance: number }>, "form" | "change" | "scale"> & { label: string };

/** How far a move goes [microsteps], typed in turns or what the user takes instead. */
export function DistanceField({ form, change, scale, label }: Props) {
  const [unit, setUnit] = useState("rev");
  return (
    <QuantityField
      label={label}
      motion="position"
      scale={scale}
      value={form.distance}
      unit={unit}
      onUnit={setUnit}
      onChange={(distance) => change({ distance })}
    />
  );
}
