import { Switch } from "@mantine/core";
import { useState } from "react";
import { NumberField } from "../../../lib/NumberField";
import { QuantityField } from "../../../lib/QuantityField";
import type { FieldsProps } from "../kind";
import { TwinFields } from "../twin/TwinFields";
import type { FastestMoveForm } from "./form";

/** The move, what it may cost, its limits, and what is known of the motor for a twin. */
export function Fields({ form, change, scale, axis }: FieldsProps<FastestMoveForm>) {
  const [unit, setUnit] = useState("rev");
  return (
    <>
      <QuantityField
        label="Distance"
        motion="position"
        scale={scale}
        value={form.distance}
        unit={unit}
        onUnit={setUnit}
        onChange={(distance) => change({ distance })}
      />
      <NumberField
        label="Margin of speed and acceleration"
        value={form.marginPercent}
        min={0}
        max={100}
        unit="%"
        onChange={(marginPercent) => change({ marginPercent })}
      />
      <NumberField
        label="Settings tried at most"
        value={form.trials}
        min={1}
        max={1000}
        integer
        onChange={(trials) => change({ trials })}
      />
      <NumberField
        label="Never faster than"
        description="empty: the soft limit, else ten times as now"
        value={form.velocityMaxPps}
        min={1}
        unit="pps"
        onChange={(velocityMaxPps) => change({ velocityMaxPps })}
        onClear={() => change({ velocityMaxPps: null })}
      />
      <NumberField
        label="Never steeper than"
        description="empty: the same"
        value={form.accelerationMaxPps2}
        min={1}
        unit="pps^2"
        onChange={(accelerationMaxPps2) => change({ accelerationMaxPps2 })}
        onClear={() => change({ accelerationMaxPps2: null })}
      />
      <TwinFields form={form.twin} change={(twin) => change({ twin })} axis={axis} />
      <Switch
        label="Quiet under way too"
        checked={form.quiet}
        onChange={({ currentTarget }) => change({ quiet: currentTarget.checked })}
      />
    </>
  );
}
