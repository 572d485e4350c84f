import { Checkbox, Select } from "@mantine/core";
import { NumberField } from "../NumberField";
import { editorOf } from "./bits";
import { chipUnit } from "./physical";
import type { ChipRows } from "./useChipRows";

interface Props {
  chip: Pick<ChipRows, "spot" | "planned" | "isStaged" | "origin" | "put">;
  register: string;
  field?: string;
  /** beside the name: what it is in a word or two */
  label?: string;
  /** the value in physical units, below it */
  physical?: ((value: number) => string) | undefined;
  disabled?: boolean;
  /** of an arrow key */
  step?: number;
}

/** One register or field with the editor that suits it; what is entered is staged. Its help comes from the catalog. */
export function ChipField({ chip, register, field, label, physical, disabled = false, step = 1 }: Props) {
  const spot = chip.spot(register, field);
  const name = field ?? register;
  if (spot === null) return null;
  const bits = spot.field ?? spot.row;
  const planned = chip.planned(register, field);
  const staged = chip.isStaged(register, field);
  const origin = chip.origin(register);
  const title = sentenceOf(bits.help ?? "", origin);
  const put = (value: number) => chip.put(register, field, value);
  const told = label === undefined ? name : `${name} · ${label}`;
  const common = { disabled, "data-testid": `field-${name}`, "data-staged": staged } as const;
  if (editorOf(bits) === "check")
    return (
      <Checkbox
        {...common}
        label={told}
        title={title}
        classNames={{ label: "text-12" }}
        checked={planned === 1}
        indeterminate={planned === null}
        onChange={(event) => put(event.currentTarget.checked ? 1 : 0)}
        data-origin={origin}
      />
    );
  if (editorOf(bits) === "select")
    return (
      <Select
        {...common}
        label={told}
        title={title}
        data={Object.entries(bits.values).map(([value, text]) => ({ value, label: text }))}
        value={planned === null ? null : String(planned)}
        placeholder="not known"
        onChange={(value) => value !== null && put(Number(value))}
      />
    );
  return (
    <NumberField
      {...common}
      label={told}
      unit={unitOf(bits.unit ?? "")}
      title={title}
      integer
      min={bits.minimum}
      max={bits.maximum}
      step={step}
      value={planned}
      placeholder="?"
      description={noteOf(planned, staged, origin, physical)}
      inputWrapperOrder={["label", "input", "description", "error"]}
      onChange={put}
    />
  );
}

function unitOf(unit: string): string {
  if (unit === "tCLK") return "clocks";
  // a fraction of a turn or a fixed point says nothing beside a field: the note below it has the angle or the number
  return /[/]/.test(unit) ? "" : chipUnit(unit);
}

function noteOf(
  value: number | null,
  staged: boolean,
  origin: string,
  physical: ((value: number) => string) | undefined,
): string {
  const meaning = value === null || physical === undefined ? "" : physical(value);
  const state = staged ? "not applied" : origin === "written" ? "as last written" : "";
  return [meaning, state].filter(Boolean).join(", ") || "\u00a0";
}

function sentenceOf(help: string, origin: string): string {
  const sentence = help === "" ? "" : `${help.charAt(0).toUpperCase()}${help.slice(1)}.`;
  if (origin === "written") return `${sentence} It cannot be read back: this is what this browser wrote last.`;
  return sentence;
}
