import { TextInput } from "@mantine/core";
import { compact } from "../../lib/format";
import type { Limits } from "./limits";

interface Props {
  label: string;
  value: string;
  onChange: (text: string) => void;
  limits: Limits;
  unit?: string;
  problem?: string | undefined;
  /** in a grid whose columns have headings: the label is for screen readers, problems stand below the grid */
  cell?: boolean;
  placeholder?: string;
}

/** Thousands apart, decimals as they are. */
function plain(value: number): string {
  return Number.isInteger(value) ? compact(value) : String(value);
}

/** A number that may be left out: the placeholder shows what then holds. */
export function OptionalNumber({ label, value, onChange, limits, unit, problem, cell = false, placeholder }: Props) {
  const holds = placeholder ?? (limits.fallback === null ? "" : plain(limits.fallback));
  return (
    <TextInput
      size="xs"
      {...(cell
        ? { "aria-label": unit ? `${label} [${unit}]` : label }
        : { label: unit ? `${label} [${unit}]` : label })}
      classNames={{ input: "num", label: "hint regular" }}
      placeholder={holds}
      value={value}
      error={problem === undefined ? false : cell ? true : problem}
      inputMode={limits.integer ? "numeric" : "decimal"}
      autoComplete="off"
      spellCheck={false}
      onChange={(event) => onChange(event.currentTarget.value)}
    />
  );
}
