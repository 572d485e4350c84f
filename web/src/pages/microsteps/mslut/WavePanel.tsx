import { Button, Menu, SegmentedControl, Slider, Switch } from "@mantine/core";
import { IconChevronDown } from "@tabler/icons-react";
import type { ReactNode } from "react";
import { coordinate, decimalSum, exactText, rounded } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import classes from "./Mslut.module.css";
import { exponentFor, type Formula, type Grid, type Part, PRESETS, rippleOf } from "./wave";

interface Props {
  formula: Formula;
  /** false while the wave is drawn by hand or pasted: the formula is what it was last */
  active: boolean;
  onChange: (formula: Formula, tag: string | null) => void;
  onSettle: () => void;
}

interface LineProps {
  label: ReactNode;
  title: string;
  value: number;
  /** of the slider; the field takes what the calculator takes */
  reach: readonly [number, number];
  range: readonly [number, number];
  step: number;
  start?: number;
  unit?: string;
  onChange: (value: number) => void;
  onSettle: () => void;
}

function Track(props: LineProps) {
  const { label, title, value, reach, range, step, start, unit = "", onChange, onSettle } = props;
  return (
    <>
      <span className="text-12" title={title}>
        {label}
      </span>
      <Slider
        min={reach[0]}
        max={reach[1]}
        step={step}
        value={Math.min(reach[1], Math.max(reach[0], value))}
        {...(start === undefined ? {} : { startPointValue: start })}
        thumbLabel={title}
        onChange={(next) => onChange(rounded(next, 6))}
        onChangeEnd={onSettle}
      />
      <NumberField
        aria-label={title}
        value={value}
        min={range[0]}
        max={range[1]}
        step={step}
        unit={unit}
        onChange={onChange}
      />
    </>
  );
}

const GRIDS: readonly { value: Grid; label: string; told: string }[] = [
  {
    value: "complement",
    label: "complement",
    told: "As after power-on: the negative half is the bitwise complement, −1 − value.",
  },
  {
    value: "opposite",
    label: "opposite",
    told: "The negative half is exactly −value: the truest angles that the table can hold.",
  },
  {
    value: "whole_step",
    label: "whole steps",
    told: "As printer firmware does it: sin at the beginning of each microstep, amplitude 247, so half a microstep off.",
  },
];

/** The wave by formula: shape, linearity exponent, harmonics, corrections of the angle. */
export function WavePanel({ formula, active, onChange, onSettle }: Props) {
  const change = (part: Partial<Formula>, tag: string | null) => onChange({ ...formula, ...part }, tag);
  const withPart = (parts: readonly Part[], order: number, part: Partial<Part>) =>
    parts.map((old) => (old.order === order ? { ...old, ...part } : old));
  const usual = formula.grid === "whole_step" ? 247 : 248;
  const grid = GRIDS.find((entry) => entry.value === formula.grid);
  return (
    // drawn by hand: the formula is what it was last
    <div className={`grid gap-8 ${active ? "" : "inactive"}`}>
      <div className="control-line">
        <Track
          label="σ"
          title="Sigma, the shape: −1 rhomb, 0 circle, +1 box"
          value={formula.sigma}
          reach={[-1, 1]}
          range={[-1, 1]}
          step={0.01}
          start={0}
          onChange={(sigma) => change({ sigma }, "sigma")}
          onSettle={onSettle}
        />
      </div>
      <div className="control-line">
        <Track
          label={
            <>
              sin<sup>f</sup>
            </>
          }
          title="f, the linearity exponent"
          value={formula.exponent}
          reach={[0.9, 1.3]}
          range={[0.2, 5]}
          step={0.005}
          start={1}
          onChange={(exponent) => change({ exponent }, "exponent")}
          onSettle={onSettle}
        />
      </div>
      <div className={classes.law}>
        <span className="hint m-0 mt-4">as firmware counts it, 1 + c/1000</span>
        <NumberField
          aria-label="Linearity correction in thousandths"
          unit="‰"
          value={Number(coordinate((formula.exponent - 1) * 1000, 9))}
          min={-800}
          max={4000}
          step={5}
          onChange={(thousandths) => change({ exponent: decimalSum(1, thousandths / 1000) }, "exponent")}
          onBlur={onSettle}
        />
        <span className="hint m-0 mt-4">against a torque ripple r of sin 4θ: f = 1 + 3r</span>
        <NumberField
          aria-label="Torque ripple that it cancels"
          unit="%"
          value={rippleOf(formula.exponent) * 100}
          show={(percent) => exactText(rounded(percent, 5))}
          min={-25}
          max={130}
          step={0.5}
          onChange={(percent) => change({ exponent: exponentFor(percent / 100) }, "exponent")}
          onBlur={onSettle}
        />
      </div>
      <p className="hint m-0 mt-4">Harmonics of the current, % of the amplitude; phase 0° or 180°</p>
      {formula.harmonics.map((part) => (
        <div key={part.order} className={`${classes.part} control-line`}>
          <Track
            label={`${part.order}θ`}
            title={`Harmonic ${part.order}`}
            unit="%"
            value={part.amount * 100}
            reach={[-20, 20]}
            range={[-100, 100]}
            step={0.1}
            start={0}
            onChange={(percent) =>
              change(
                { harmonics: withPart(formula.harmonics, part.order, { amount: percent / 100 }) },
                `h${part.order}`,
              )
            }
            onSettle={onSettle}
          />
          <NumberField
            aria-label={`Phase of harmonic ${part.order}`}
            unit="deg"
            value={part.phase_deg}
            min={-360}
            max={360}
            step={180}
            onChange={(phase_deg) =>
              change({ harmonics: withPart(formula.harmonics, part.order, { phase_deg }) }, null)
            }
          />
        </div>
      ))}
      <p className="hint m-0 mt-4">Corrections of the angle, electrical degrees; phase 0° or 180°</p>
      {formula.corrections.map((part) => (
        <div key={part.order} className={`${classes.part} control-line`}>
          <Track
            label={`sin ${part.order}θ`}
            title={`Angle correction of order ${part.order}`}
            unit="deg"
            value={part.amount}
            reach={[-5, 5]}
            range={[-45, 45]}
            step={0.05}
            start={0}
            onChange={(amount) =>
              change({ corrections: withPart(formula.corrections, part.order, { amount }) }, `c${part.order}`)
            }
            onSettle={onSettle}
          />
          <NumberField
            aria-label={`Phase of correction ${part.order}`}
            unit="deg"
            value={part.phase_deg}
            min={-360}
            max={360}
            step={180}
            onChange={(phase_deg) =>
              change({ corrections: withPart(formula.corrections, part.order, { phase_deg }) }, null)
            }
          />
        </div>
      ))}
      <div className="control-line">
        <Track
          label="amplitude"
          title="Amplitude, the largest value"
          value={formula.amplitude ?? usual}
          reach={[1, 255]}
          range={[1, 400]}
          step={1}
          onChange={(amplitude) => change({ amplitude: amplitude === usual ? null : amplitude }, "amplitude")}
          onSettle={onSettle}
        />
      </div>
      <div className="flex wrap end gap-8">
        <SegmentedControl
          aria-label="Negative half and grid"
          value={formula.grid}
          onChange={(next) => change({ grid: next as Grid }, null)}
          data={GRIDS.map(({ value, label }) => ({ value, label }))}
        />
        <Switch
          label="fill"
          title="Stretch a box until it reaches the amplitude"
          checked={formula.full_scale}
          mb={6}
          onChange={(event) => change({ full_scale: event.currentTarget.checked }, null)}
        />
        <Menu position="bottom-end" width={290}>
          <Menu.Target>
            <Button variant="default" rightSection={<IconChevronDown size={14} aria-hidden />} ml="auto">
              Presets
            </Button>
          </Menu.Target>
          <Menu.Dropdown>
            {PRESETS.map((preset) => (
              <Menu.Item key={preset.name} onClick={() => onChange(preset.formula, null)}>
                {preset.name}
              </Menu.Item>
            ))}
          </Menu.Dropdown>
        </Menu>
      </div>
      <p className="hint m-0 mt-4">
        {active ? grid?.told : "The wave is drawn by hand; any change here goes back to the formula."}
      </p>
    </div>
  );
}
