import { Select } from "@mantine/core";
import type { PropsWithChildren, ReactNode } from "react";
import { NumberField } from "../../lib/NumberField";
import type { Settings } from "../../lib/rows/settings";
import classes from "./stallguard.module.css";

interface RowProps {
  settings: Settings;
  disabled: boolean;
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

function Row({ settings, name, label, alias, note, children }: PropsWithChildren<RowProps>) {
  return (
    <div className={classes.row} data-staged={settings.staged.has(name)}>
      <span className="text-12 tight">
        {label} <span className="hint nowrap">{alias}</span>
      </span>
      {children}
      <span className="hint tight whole">{note}</span>
    </div>
  );
}

export function NumberRow({ min, max, unit = "", step = 1, show, ...row }: NumberRowProps) {
  const { settings, disabled, name, label, alias } = row;
  return (
    <Row {...row}>
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
    </Row>
  );
}

export function ChoiceRow({ choices, ...row }: RowProps & { choices: readonly string[] }) {
  const { settings, disabled, name, label, alias } = row;
  const value = settings.planned(name);
  return (
    <Row {...row}>
      <Select
        aria-label={`${label}, ${alias}`}
        data={choices.map((choice, index) => ({ value: String(index), label: choice }))}
        value={value === null ? null : String(value)}
        placeholder="unknown"
        disabled={disabled}
        onChange={(next) => next !== null && settings.stage(name, Number(next))}
        data-testid={name}
      />
    </Row>
  );
}

export const FILTERS = ["each full step", "mean of four"] as const;
export const MINIMA = ["½ of run", "¼ of run"] as const;
export const UPS = ["1 a reading", "2 a reading", "4 a reading", "8 a reading"] as const;
export const DOWNS = ["in 32 readings", "in 8 readings", "in 2 readings", "each reading"] as const;
