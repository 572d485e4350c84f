import { Switch } from "@mantine/core";
import { NumberField } from "../../../lib/NumberField";
import type { FieldsProps } from "../kind";
import type { MicrostepForm } from "./form";

/** How far and how slowly the motor turns, how often it is proved, and whether a better table stays. */
export function Fields({ form, change }: FieldsProps<MicrostepForm>) {
  return (
    <>
      <NumberField
        label="Each run"
        value={form.turns}
        min={1}
        max={10}
        integer
        unit="turns"
        onChange={(turns) => change({ turns })}
      />
      <NumberField
        label="Speed"
        description="so slow that the load follows four errors a full step"
        value={form.velocityRps}
        min={0.002}
        max={0.5}
        unit="turns/s"
        onChange={(velocityRps) => change({ velocityRps })}
      />
      <NumberField
        label="Pairs of the proof"
        value={form.pairs}
        min={6}
        max={50}
        integer
        onChange={(pairs) => change({ pairs })}
      />
      <Switch
        label="Leave the new table set where it is shown to be better"
        checked={form.keep}
        onChange={({ currentTarget }) => change({ keep: currentTarget.checked })}
      />
    </>
  );
}
