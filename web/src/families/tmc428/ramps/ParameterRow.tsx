import { Slider } from "@mantine/core";
import type { ReactNode } from "react";
import { NumberField } from "../../../lib/NumberField";
import classes from "./Ramps.module.css";

interface Physical {
  value: number;
  unit: string;
  onChange: (value: number) => void;
  max: number;
}

interface Props {
  label: string;
  title: string;
  value: number;
  min?: number;
  max: number;
  onChange: (value: number) => void;
  /** the same in the unit of choice, also to be typed into */
  physical?: Physical;
  /** in place of `physical`: what the value means */
  meaning?: ReactNode;
  /** the part of the slider that may be used; outside it is hatched */
  allowed?: readonly [number, number];
  /** a line below: the other units, or a warning */
  below?: ReactNode;
  marks?: { value: number; label?: ReactNode }[];
}

/** A parameter: slider, chip units and physical units side by side. */
export function ParameterRow(props: Props) {
  const { label, title, value, min = 0, max, onChange, physical, meaning, allowed, below, marks } = props;
  const share = (at: number) => `${((at - min) / (max - min)) * 100}%`;
  return (
    <div className={classes.row}>
      <span className="text-12 mono" title={title}>
        {label}
      </span>
      <div className="shrink relative">
        {allowed && allowed[0] > min && (
          <span
            className={classes.forbidden}
            style={{ left: 0, width: share(Math.min(max, allowed[0])) }}
            aria-hidden
          />
        )}
        {allowed && allowed[1] < max && (
          <span className={classes.forbidden} style={{ left: share(allowed[1]), right: 0 }} aria-hidden />
        )}
        <Slider
          min={min}
          max={max}
          value={value}
          onChange={onChange}
          thumbLabel={`${label}, ${title}`}
          {...(marks ? { marks } : {})}
        />
      </div>
      <NumberField
        aria-label={`${label} in chip units`}
        value={value}
        min={min}
        max={max}
        integer
        onChange={onChange}
      />
      {physical ? (
        <NumberField
          aria-label={`${label} in ${physical.unit}`}
          value={physical.value}
          unit={physical.unit}
          min={0}
          max={physical.max}
          step={physical.max / 200}
          onChange={physical.onChange}
        />
      ) : (
        <span className={`num hint clip`}>{meaning}</span>
      )}
      {below !== undefined && <div className={`${classes.below} rest lines-12 text-12`}>{below}</div>}
    </div>
  );
}
