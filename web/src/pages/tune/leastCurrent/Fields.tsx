import { Checkbox } from "@mantine/core";
import { useState } from "react";
import { NumberField } from "../../../lib/NumberField";
import { QuantityField } from "../../../lib/QuantityField";
import type { FieldsProps } from "../kind";
import { TwinFields } from "../twin/TwinFields";
import type { LeastCurrentForm } from "./form";

/** The load cycle, the margin, how sure it has to be, and what watts are reckoned with. */
export function Fields({ form, change, scale, axis }: FieldsProps<LeastCurrentForm>) {
  const [unit, setUnit] = useState("rev");
  return (
    <>
      <QuantityField
        label="Load cycle: there and back"
        motion="position"
        scale={scale}
        value={form.distance}
        unit={unit}
        onUnit={setUnit}
        onChange={(distance) => change({ distance })}
      />
      <NumberField
        label="Margin of current"
        description="for a heavier load, a warm motor"
        value={form.marginPercent}
        min={0}
        max={60}
        unit="%"
        onChange={(marginPercent) => change({ marginPercent })}
      />
      <NumberField
        label="Margin of speed"
        description="for a supply that sags: tried as so much more speed; 0: not tried"
        value={form.speedPercent}
        min={0}
        max={100}
        unit="%"
        onChange={(speedPercent) => change({ speedPercent })}
      />
      <NumberField
        label="Cycles that may lose a step, at most"
        description="1 % takes 299 cycles to show, 5 % takes 59"
        value={form.lossPercent}
        min={0.1}
        max={20}
        unit="%"
        onChange={(lossPercent) => change({ lossPercent })}
      />
      <NumberField
        label="Resistance of one coil"
        description="empty: the saving is a share, not watts"
        value={form.resistanceOhm}
        min={0.01}
        max={200}
        unit="Ω"
        onChange={(resistanceOhm) => change({ resistanceOhm })}
        onClear={() => change({ resistanceOhm: null })}
      />
      <NumberField
        label="Run current as it is set now, RMS of one coil"
        value={form.runCurrentA}
        min={0.01}
        max={30}
        unit="A"
        onChange={(runCurrentA) => change({ runCurrentA })}
        onClear={() => change({ runCurrentA: null })}
      />
      <TwinFields form={form.twin} change={(twin) => change({ twin })} axis={axis} />
      <Checkbox
        label="CoolStep too"
        description="where the chip has it: less current where the load is small"
        checked={form.coolstep}
        onChange={(event) => change({ coolstep: event.currentTarget.checked })}
      />
    </>
  );
}
