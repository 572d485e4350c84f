import { Group, Select } from "@mantine/core";
import { NumberField } from "./NumberField";
import { type AxisScale, fromSteps, symbolOf, toSteps, unitsFor } from "./units";

interface Props {
  label: string;
  motion: "position" | "velocity" | "acceleration";
  scale: AxisScale;
  /** in microsteps, pps or pps²: what is kept; the unit is only how it is shown and typed */
  value: number | null;
  onChange: (steps: number) => void;
  unit: string;
  onUnit: (unit: string) => void;
  min?: number;
  max?: number;
  disabled?: boolean;
}

/** A position, velocity or acceleration in the unit of choice of one axis. */
export function QuantityField(props: Props) {
  const { label, motion, scale, value, onChange, unit, onUnit, min, max, disabled = false } = props;
  const units = unitsFor(motion, scale);
  const shown = units.includes(unit) ? unit : (units[0] ?? "");
  const convert = (steps: number) => fromSteps(steps, shown, scale, motion);
  return (
    <Group gap={4} wrap="nowrap" align="flex-end">
      <NumberField
        label={label}
        value={value === null ? null : convert(value)}
        onChange={(typed) => onChange(toSteps(typed, shown, scale, motion))}
        disabled={disabled}
        flex={1}
        miw={70}
        {...(min === undefined ? {} : { min: convert(min) })}
        {...(max === undefined ? {} : { max: convert(max) })}
      />
      <Select
        aria-label={`Unit of ${label.toLowerCase()}`}
        w={84}
        data={units.map((candidate) => ({ value: candidate, label: symbolOf(candidate) }))}
        value={shown}
        disabled={disabled}
        comboboxProps={{ width: "max-content" }}
        onChange={(next) => next && onUnit(next)}
      />
    </Group>
  );
}
