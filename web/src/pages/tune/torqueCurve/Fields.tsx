import { NumberField } from "../../../lib/NumberField";
import type { FieldsProps } from "../kind";
import type { TorqueForm } from "./form";

/** How far and how fast it may go, at how many speeds it is looked at, and what is known of its load. */
export function Fields({ form, change }: FieldsProps<TorqueForm>) {
  return (
    <>
      <NumberField
        label="Room to positions above"
        value={form.travelTurns}
        min={10}
        max={10_000}
        unit="turns"
        onChange={(travelTurns) => change({ travelTurns })}
      />
      <NumberField
        label="Never faster than"
        value={form.velocityMaxRps}
        min={1}
        max={100}
        unit="turns/s"
        onChange={(velocityMaxRps) => change({ velocityMaxRps })}
      />
      <NumberField
        label="Speeds"
        value={form.speeds}
        min={2}
        max={30}
        integer
        onChange={(speeds) => change({ speeds })}
      />
      <NumberField
        label="Slips at each speed"
        value={form.repeats}
        min={2}
        max={20}
        integer
        onChange={(repeats) => change({ repeats })}
      />
      <NumberField
        label="Inertia of rotor and load, at the motor"
        description="empty: the acceleration over speed is told, not the torque"
        value={form.inertiaKgm2}
        min={1e-9}
        max={1}
        unit="kg m²"
        onChange={(inertiaKgm2) => change({ inertiaKgm2 })}
        onClear={() => change({ inertiaKgm2: null })}
      />
      {form.inertiaKgm2 !== null && (
        <>
          <NumberField
            label="It is known within ±"
            value={form.inertiaPercent}
            min={0}
            max={50}
            unit="%"
            onChange={(inertiaPercent) => change({ inertiaPercent })}
          />
          <NumberField
            label="Friction of the axis"
            description="added to the torque; 0: what is told is beyond friction"
            value={form.frictionNm}
            min={0}
            max={50}
            unit="N m"
            onChange={(frictionNm) => change({ frictionNm })}
          />
        </>
      )}
    </>
  );
}
