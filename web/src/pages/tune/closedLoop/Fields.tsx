import { Switch } from "@mantine/core";
import { NumberField } from "../../../lib/NumberField";
import type { FieldsProps } from "../kind";
import type { ClosedLoopForm } from "./form";

/** Which margins the loop shall have, and the steps by which it is shown. */
export function Fields({ form, change }: FieldsProps<ClosedLoopForm>) {
  return (
    <>
      <NumberField
        label="Phase margin"
        description="less: faster, and more overshoot"
        value={form.phaseMarginDeg}
        min={30}
        max={80}
        unit="°"
        onChange={(phaseMarginDeg) => change({ phaseMarginDeg })}
      />
      <NumberField
        label="Gain margin"
        description="times more gain before it oscillates; 2 is 6 dB"
        value={form.gainMargin}
        min={1.3}
        max={10}
        onChange={(gainMargin) => change({ gainMargin })}
      />
      <NumberField
        label="Step"
        value={form.stepFullsteps}
        min={0.5}
        max={50}
        unit="full steps"
        onChange={(stepFullsteps) => change({ stepFullsteps })}
      />
      <Switch
        label="Leave the new gains set, and the loop on, where they do as asked"
        checked={form.keep}
        onChange={({ currentTarget }) => change({ keep: currentTarget.checked })}
      />
    </>
  );
}
