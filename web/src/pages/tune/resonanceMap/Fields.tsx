import { Switch } from "@mantine/core";
import { NumberField } from "../../../lib/NumberField";
import type { FieldsProps } from "../kind";
import type { ResonanceForm } from "./form";

/** Which speeds are looked at, with how much room, and which changes are compared. */
export function Fields({ form, change }: FieldsProps<ResonanceForm>) {
  return (
    <>
      <NumberField
        label="Slowest"
        value={form.velocityMinRps}
        min={0.05}
        max={20}
        unit="turns/s"
        onChange={(velocityMinRps) => change({ velocityMinRps })}
      />
      <NumberField
        label="Fastest"
        description="twice the slowest at the least; as far as travel and acceleration let it get there"
        value={form.velocityMaxRps}
        min={0.1}
        max={50}
        unit="turns/s"
        onChange={(velocityMaxRps) => change({ velocityMaxRps })}
      />
      <NumberField
        label="Room to positions above"
        value={form.travelTurns}
        min={1}
        max={10_000}
        unit="turns"
        onChange={(travelTurns) => change({ travelTurns })}
      />
      <NumberField
        label="Speeds"
        description="more are made around what resonates"
        value={form.speeds}
        min={8}
        max={60}
        integer
        onChange={(speeds) => change({ speeds })}
      />
      <NumberField
        label="Ways there and back at each"
        value={form.repeats}
        min={1}
        max={10}
        integer
        onChange={(repeats) => change({ repeats })}
      />
      <NumberField
        label="Compare with another current"
        description="of the run current; empty: none"
        value={form.currentPercent}
        min={20}
        max={200}
        unit="%"
        onChange={(currentPercent) => change({ currentPercent })}
        onClear={() => change({ currentPercent: null })}
      />
      <Switch
        label="Compare with the other chopper (StealthChop, SpreadCycle)"
        checked={form.otherChopper}
        onChange={({ currentTarget }) => change({ otherChopper: currentTarget.checked })}
      />
    </>
  );
}
