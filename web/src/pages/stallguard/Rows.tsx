import { Select } from "@mantine/core";
import type { ReactNode } from "react";
import { NumberField } from "../../lib/NumberField";
import type { Settings } from "../../lib/rows/settings";
import classes from "./stallguard.module.css";

export interface Common {
  settings: Settings;
  disabled: boolean;
}

interface RowProps extends Common {
  name: string;
  label: string;
  /** where the device keeps it */
  alias: string;
  note?: ReactNode;
}

interface NumberRowProps extends RowProps {
  min: number;
  max: number;
  unit?: string;
  step?: number;
  /** as the device holds it, a number may be no whole one */
  show?: (value: number) => string;
}

export function NumberRow(props: NumberRowProps) {
  const { settings, disabled, name, label, alias, note, min, max, unit = "", step = 1, show } = props;
  return (
    <div className={classes.row} data-staged={settings.staged.has(name)}>
      <span className="text-12 tight">
        {label} <span className="hint nowrap">{alias}</span>
      </span>
      <NumberField
        aria-label={`${label}, ${alias}`}
        integer={show === undefined}
        {...(show ? { show } : {})}
        value={settings.planned(name)}
        placeholder="unknown"
        unit={unit}
        min={min}
        max={max}
        step={step}
        disabled={disabled}
        onChange={(value) => settings.stage(name, value)}
        data-testid={name}
      />
      <span className="hint tight whole">{note}</span>
    </div>
  );
}

export function ChoiceRow({
  settings,
  disabled,
  name,
  label,
  alias,
  note,
  choices,
}: RowProps & { choices: readonly string[] }) {
  const value = settings.planned(name);
  return (
    <div className={classes.row} data-staged={settings.staged.has(name)}>
      <span className="text-12 tight">
        {label} <span className="hint nowrap">{alias}</span>
      </span>
      <Select
        aria-label={`${label}, ${alias}`}
        data={choices.map((choice, index) => ({ value: String(index), label: choice }))}
        value={value === null ? null : String(value)}
        placeholder="unknown"
        disabled={disabled}
        onChange={(next) => next !== null && settings.stage(name, Number(next))}
        data-testid={name}
      />
      <span className="hint tight whole">{note}</span>
    </div>
  );
}

export const FILTERS = ["each full step", "mean of four"] as const;
export const MINIMA = ["½ of run", "¼ of run"] as const;
export const UPS = ["1 a reading", "2 a reading", "4 a reading", "8 a reading"] as const;
export const DOWNS = ["in 32 readings", "in 8 readings", "in 2 readings", "each reading"] as const;
