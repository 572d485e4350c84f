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
      <NumberField
        label="Supply of the motor"
        description="with the run current: the coil's resistance"
        value={form.supplyV}
        min={1}
        max={100}
        unit="V"
        onChange={(supplyV) => change({ supplyV })}
        onClear={() => change({ supplyV: null })}
      />
      <NumberField
        label="Run current as it is set now, RMS of one coil"
        value={form.runCurrentA}
        min={0.01}
        max={50}
        unit="A"
        onChange={(runCurrentA) => change({ runCurrentA })}
        onClear={() => change({ runCurrentA: null })}
      />
      <NumberField
        label="Inductance of one coil"
        description="with both: the back-EMF"
        value={form.inductanceMh}
        min={0.01}
        max={500}
        unit="mH"
        onChange={(inductanceMh) => change({ inductanceMh })}
        onClear={() => change({ inductanceMh: null })}
      />
    </>
  );
}
