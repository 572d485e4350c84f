import { NumberField } from "../../../lib/NumberField";
import { CoilFields } from "../CoilFields";
import type { FieldsProps } from "../kind";
import type { StealthChopForm } from "./form";

/** The motor and its supply, up to which speed it is run, and how much of a jolt is allowed. */
export function Fields({ form, change }: FieldsProps<StealthChopForm>) {
  return (
    <>
      <CoilFields form={form} change={change} />
      <NumberField
        label="Holding torque"
        description="empty: the chip alone tunes what velocity adds"
        value={form.holdingTorqueNm}
        min={0.001}
        max={50}
        unit="N m"
        onChange={(holdingTorqueNm) => change({ holdingTorqueNm })}
        onClear={() => change({ holdingTorqueNm: null })}
      />
      <NumberField
        label="Rated current, RMS of one coil"
        description="at that torque; empty: the run current"
        value={form.ratedCurrentA}
        min={0.01}
        max={50}
        unit="A"
        onChange={(ratedCurrentA) => change({ ratedCurrentA })}
        onClear={() => change({ ratedCurrentA: null })}
      />
      <NumberField
        label="Up to a speed of"
        description="runs go through all speeds up to it"
        value={form.velocityMaxRps}
        min={0.3}
        max={20}
        unit="turns/s"
        onChange={(velocityMaxRps) => change({ velocityMaxRps })}
      />
      <NumberField
        label="Jolt that is allowed"
        description="swing of the shaft as the choppers change"
        value={form.joltMax}
        min={0.02}
        max={2}
        unit="full steps"
        onChange={(joltMax) => change({ joltMax })}
      />
    </>
  );
}
