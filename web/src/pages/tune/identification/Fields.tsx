import { NumberField } from "../../../lib/NumberField";
import type { FieldsProps } from "../kind";
import type { IdentificationForm } from "./form";

/** How slowly it turns, how often it hops, and the torque that makes an inertia of a resonance. */
export function Fields({ form, change }: FieldsProps<IdentificationForm>) {
  return (
    <>
      <NumberField
        label="Speed of the slow turns"
        value={form.velocityRps}
        min={0.01}
        max={0.5}
        unit="turns/s"
        onChange={(velocityRps) => change({ velocityRps })}
      />
      <NumberField
        label="Hops"
        description="after each of them the rotor rings"
        value={form.hops}
        min={6}
        max={100}
        integer
        onChange={(hops) => change({ hops })}
      />
      <NumberField
        label="Holding torque"
        description="with the run current; empty: no inertia"
        value={form.holdTorqueNm}
        min={0.0001}
        max={50}
        unit="N m"
        onChange={(holdTorqueNm) => change({ holdTorqueNm })}
        onClear={() => change({ holdTorqueNm: null })}
      />
    </>
  );
}
