import { NumberField } from "../../../lib/NumberField";
import type { FieldsProps } from "../kind";
import type { FirstLookForm } from "./form";

/** How far a first look turns, and how far it looks for switches. */
export function Fields({ form, change }: FieldsProps<FirstLookForm>) {
  return (
    <>
      <NumberField
        label="Turn to either side"
        value={form.turns}
        min={0.1}
        max={20}
        unit="turns"
        onChange={(turns) => change({ turns })}
      />
      <NumberField
        label="Look for switches as far as"
        description="0: not at all"
        value={form.travelTurns}
        min={0}
        max={10_000}
        unit="turns"
        onChange={(travelTurns) => change({ travelTurns })}
      />
    </>
  );
}
