import { memo } from "react";
import { optionsOf } from "../../../lib/choices";
import type { Reach } from "../../../lib/ramp/HandleLayer";
import { type Preset, RampRegisters } from "../../../lib/ramp/RampRegisters";
import { factor, type Units } from "../../../lib/ramp/scales";
import { ValueRow } from "../../../lib/ramp/ValueRow";
import type { AxisScale } from "../../../lib/units";
import { type Design, KIND, type Lock, MEANING, type Parameter, PRESETS } from "./design";
import type { Finding } from "./findings";
import { type Raw, REGISTERS, typedOf, unitOf } from "./registers";

interface Props {
  design: Design;
  raws: Raw;
  onChange: (parameter: Parameter, value: number) => void;
  onPreset: (preset: Preset<Design>) => void;
  lock: Lock;
  onLock: (lock: Lock) => void;
  units: Units;
  scale: AxisScale;
  reach: (parameter: Parameter) => Reach;
  findings: readonly Finding[];
  /** null where there is nothing to read */
  onRead: (() => void) | null;
  /** why, where a chip is there */
  unread: string;
  reading: boolean;
}

const GROUPS: readonly { title: string; parameters: readonly Parameter[] }[] = [
  { title: "Speeding up", parameters: ["vstart", "a1", "v1", "amax", "vmax"] },
  { title: "Braking", parameters: ["dmax", "d1", "vstop"] },
  { title: "At rest", parameters: ["tzerowait"] },
];
/** In which the wait is typed [s]. */
const MS = 1e-3;
const LOCKS: readonly { value: Lock; label: string }[] = optionsOf({ mirrored: "up = down", free: "free" });

/** The registers of the ramp, in the unit of choice and in those of the chip. */
export const Parameters = memo(function Parameters(props: Props) {
  return (
    <RampRegisters
      clockHz={props.scale.clockHz}
      presets={PRESETS}
      onPreset={props.onPreset}
      onRead={props.onRead}
      unread={props.unread}
      reading={props.reading}
      locks={LOCKS}
      lock={props.lock}
      onLock={props.onLock}
      groups={GROUPS}
      typed
      row={(parameter) => <Row parameter={parameter} {...props} />}
    />
  );
});

function Row(props: Props & { parameter: Parameter }) {
  const { parameter, design, raws, units, scale } = props;
  const wait = parameter === "tzerowait";
  const raw = raws[parameter];
  const said = props.findings.filter((finding) => finding.parameter === parameter);
  const texts = (level: Finding["level"]) => said.filter((finding) => finding.level === level).map(({ text }) => text);
  return (
    <ValueRow
      name={REGISTERS[parameter].name}
      meaning={MEANING[parameter]}
      value={design[parameter]}
      per={wait ? MS : factor(KIND[parameter], units, scale)}
      unit={wait ? "ms" : units[KIND[parameter]]}
      reach={props.reach(parameter)}
      onChange={(value) => props.onChange(parameter, value)}
      register={{ raw, value: raw * unitOf(parameter, scale.clockHz) }}
      chip={{
        least: 0,
        most: REGISTERS[parameter].most,
        onChange: (typed) => props.onChange(parameter, typedOf(parameter, typed, scale.clockHz)),
      }}
      ignored={said.some((finding) => finding.text.startsWith("no part"))}
      hints={texts("hint")}
      cautions={texts("caution")}
    />
  );
}
