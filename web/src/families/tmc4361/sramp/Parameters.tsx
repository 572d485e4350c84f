import { SegmentedControl, Switch } from "@mantine/core";
import { memo } from "react";
import { optionsOf } from "../../../lib/choices";
import type { Answer } from "../../../lib/ramp/answer";
import type { Reach } from "../../../lib/ramp/HandleLayer";
import { type Preset, RampRegisters } from "../../../lib/ramp/RampRegisters";
import { factor, type Units } from "../../../lib/ramp/scales";
import { ValueRow } from "../../../lib/ramp/ValueRow";
import type { AxisScale } from "../../../lib/units";
import {
  type Design,
  KIND,
  type Lock,
  MEANING,
  type Options,
  type Parameter,
  PRESETS,
  type Shape,
  used,
} from "./design";

interface Props {
  design: Design;
  onChange: (parameter: Parameter, value: number) => void;
  onPreset: (preset: Preset<Design>) => void;
  lock: Lock;
  onLock: (lock: Lock) => void;
  options: Options;
  onOptions: (change: Partial<Options>) => void;
  units: Units;
  scale: AxisScale;
  reach: (parameter: Parameter) => Reach;
  /** what the calculator said last */
  answer: Answer | undefined;
  /** null where there is no chip to read */
  onRead: (() => void) | null;
  reading: boolean;
}

const GROUPS: readonly { title: string; parameters: readonly Parameter[] }[] = [
  { title: "Limits", parameters: ["vmax", "amax", "dmax"] },
  { title: "Bows", parameters: ["bow1", "bow2", "bow3", "bow4"] },
  { title: "Start and stop", parameters: ["vbreak", "vstart", "astart", "vstop", "dfinal"] },
];
const LOCKS: readonly { value: Lock; label: string }[] = optionsOf({
  equal: "all equal",
  mirrored: "up = down",
  free: "free",
});

/** The registers of the ramp in the unit of choice, and what their fixed point makes of them. */
export const Parameters = memo(function Parameters(props: Props) {
  const { options, onOptions } = props;
  return (
    <RampRegisters
      clockHz={props.scale.clockHz}
      presets={PRESETS}
      onPreset={options.shape === "s" ? props.onPreset : null}
      onRead={props.onRead}
      reading={props.reading}
      choices={
        <SegmentedControl
          aria-label="Shape of the ramp"
          value={options.shape}
          onChange={(shape: Shape) => onOptions({ shape })}
          data={optionsOf({ s: "S-ramp", trapezoid: "trapezoid", hold: "hold" })}
        />
      }
      locks={LOCKS}
      lock={props.lock}
      onLock={options.shape === "hold" ? null : props.onLock}
      groups={GROUPS}
      used={used(options)}
      row={(parameter) => <Row parameter={parameter} {...props} />}
    >
      <div className="lines-16 mt-8">
        {options.shape === "s" && (
          <Switch
            label="start with ASTART after VSTART"
            description="use_astart_and_vstart"
            checked={options.useAstart}
            onChange={(event) => onOptions({ useAstart: event.currentTarget.checked })}
          />
        )}
        {options.shape !== "hold" && (
          <Switch
            label="accelerations per clock²"
            description="direct_acc_val_en: for short, steep ramps"
            checked={options.directAcceleration}
            onChange={(event) => onOptions({ directAcceleration: event.currentTarget.checked })}
          />
        )}
        {options.shape === "s" && (
          <Switch
            label="bows per clock³"
            description="direct_bow_val_en: bows above 16.8 Mpps³"
            checked={options.directBow}
            onChange={(event) => onOptions({ directBow: event.currentTarget.checked })}
          />
        )}
      </div>
    </RampRegisters>
  );
});

/** Values without which there is no motion may not be 0. */
const NEVER_ZERO: readonly Parameter[] = ["vmax", "amax", "dmax", "bow1", "bow2", "bow3", "bow4"];

export function leastOf(parameter: Parameter, step: number): number {
  return NEVER_ZERO.includes(parameter) ? step : 0;
}

function Row({ parameter, design, onChange, units, scale, reach, answer, options }: Props & { parameter: Parameter }) {
  const kind = KIND[parameter];
  const ignored = parameter === "dfinal" && options.mode === "position" && options.shape === "s";
  return (
    <ValueRow
      name={parameter.toUpperCase()}
      meaning={MEANING[parameter]}
      value={design[parameter]}
      per={factor(kind, units, scale)}
      unit={units[kind]}
      reach={reach(parameter)}
      onChange={(value) => onChange(parameter, value)}
      register={answer?.registers.find((candidate) => candidate.parameter === parameter) ?? null}
      ignored={ignored}
      hints={ignored ? ["ignored while positioning"] : []}
      cautions={(answer?.findings ?? [])
        .filter((finding) => finding.parameter === parameter)
        .map((finding) => finding.text)}
    />
  );
}
