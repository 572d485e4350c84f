import type { ReactNode } from "react";
import { compact, fixed, rounded, withUnit } from "../format";
import { NumberField } from "../NumberField";
import type { Reach } from "./HandleLayer";
import classes from "./ramp.module.css";

const DIGITS = 6;

interface Props {
  /** the register, as it is called */
  name: string;
  meaning: string;
  /** wished [pps, pps², pps³, s] */
  value: number;
  /** what one of the shown unit is in that */
  per: number;
  unit: string;
  reach: Reach;
  onChange: (value: number) => void;
  /** what the register holds, and what that stands for; null while it is not known */
  register: { raw: number; value: number } | null;
  /** where the register's own number can be typed as well: its greatest, and what to do with it */
  chip?: { most: number; least: number; onChange: (raw: number) => void };
  /** it has no part in this ramp */
  ignored?: boolean;
  hints?: readonly string[];
  cautions?: readonly string[];
}

/** A register of a ramp: the value that is wished for, and what the register makes of it. */
export function ValueRow(props: Props) {
  const { name, meaning, value, per, unit, reach, onChange, register, chip, ignored = false } = props;
  const { hints = [], cautions = [] } = props;
  // what is not seen in so many digits is no rounding to speak of
  const digits = (each: number) => rounded(each / per, DIGITS);
  const inexact = register !== null && digits(register.value) !== digits(value);
  const equals: ReactNode = inexact && (
    <span
      className={`num ${classes.rounded} caution text-12`}
      title={`the register stands for ${withUnit(register.value / per, unit, 9)}`}
    >
      = {chip ? compact(register.value / per, DIGITS) : withUnit(register.value / per, unit, DIGITS)}
    </span>
  );
  return (
    <div className={classes.row} data-chip={chip !== undefined || undefined}>
      <span className={`text-12 mono ${ignored ? "dim" : ""}`} title={meaning}>
        {name}
      </span>
      <NumberField
        aria-label={`${name} in ${unit}`}
        value={value / per}
        unit={unit}
        min={reach.least / per}
        max={reach.most / per}
        step={Math.max(reach.step, value / 100) / per}
        onChange={(typed) => onChange(typed * per)}
      />
      {chip ? (
        <>
          <NumberField
            aria-label={`${name} in chip units`}
            value={register?.raw ?? null}
            integer
            min={chip.least}
            max={chip.most}
            step={Math.max(1, Math.round((register?.raw ?? 0) / 100))}
            onChange={chip.onChange}
          />
          {equals}
        </>
      ) : (
        <span className="lines-8 hint" title="what the register holds">
          <span className="num">{register ? fixed(register.raw) : "–"}</span>
          {equals}
        </span>
      )}
      {hints.length + cautions.length > 0 && (
        <div className="rest grid text-12">
          {hints.map((text) => (
            <span key={text} className="hint m-0">
              {text}
            </span>
          ))}
          {cautions.map((text) => (
            <span key={text} className="m-0 caution text-12">
              {text}
            </span>
          ))}
        </div>
      )}
    </div>
  );
}
