import { Button, Menu, SegmentedControl, Slider, Switch } from "@mantine/core";
import { IconChevronDown } from "@tabler/icons-react";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import classes from "./Microsteps.module.css";
import { type Formula, type Method, PRESETS } from "./table";

interface Props {
  formula: Formula;
  /** false while the table is drawn by hand or pasted: the formula is what it was last */
  active: boolean;
  onChange: (formula: Formula, tag: string | null) => void;
  onSettle: () => void;
}

/** The three shapes as a current vector draws them: rhomb, circle, box. */
function Shape({ kind }: { kind: "rhomb" | "circle" | "box" }) {
  return (
    <svg
      width="16"
      height="16"
      viewBox="0 0 16 16"
      fill="none"
      stroke="currentColor"
      strokeWidth={1.3}
      aria-hidden="true"
    >
      {kind === "rhomb" && <path d="M8 1.5 L14.5 8 L8 14.5 L1.5 8 Z" />}
      {kind === "circle" && <circle cx="8" cy="8" r="6" />}
      {kind === "box" && <rect x="3" y="3" width="10" height="10" />}
    </svg>
  );
}

export function Line(props: {
  label: string;
  title: string;
  value: number;
  min: number;
  max: number;
  step: number;
  onChange: (value: number) => void;
  onSettle: () => void;
}) {
  const { label, title, value, min, max, step, onChange, onSettle } = props;
  return (
    <div className="control-line">
      <span className="text-12" title={title}>
        {label}
      </span>
      <Slider
        min={min}
        max={max}
        step={step}
        value={value}
        thumbLabel={title}
        onChange={onChange}
        onChangeEnd={onSettle}
      />
      <NumberField aria-label={title} value={value} min={min} max={max} step={step} onChange={onChange} />
    </div>
  );
}

/** The table by formula: shape, offset, amplitude, rounding (data sheet, chapter 12). */
export function FormulaPanel({ formula, active, onChange, onSettle }: Props) {
  const change = (part: Partial<Formula>, tag: string | null) => onChange({ ...formula, ...part }, tag);
  const outside = Math.abs(formula.sigma) > 0.5;
  return (
    // drawn by hand: the formula is what it was last
    <div className={`pt-8 grid gap-8 mt-8 rule-top ${active ? "" : "inactive"}`}>
      <div className="control-line start">
        <span className="text-12" title="shape: −1 rhomb, 0 circle, +1 box">
          σ
        </span>
        <div className="relative pt-8">
          <span className={classes.sheetRange} aria-hidden="true" />
          <Slider
            min={-1}
            max={1}
            step={0.01}
            value={formula.sigma}
            startPointValue={0}
            thumbLabel="Sigma, the shape"
            thumbValueText={(value) =>
              `${value}, ${value === 0 ? "circle" : value > 0 ? "towards box" : "towards rhomb"}`
            }
            onChange={(sigma) => change({ sigma }, "sigma")}
            onChangeEnd={onSettle}
          />
          <div className="hint flex between mt-4 relative">
            <span className="inline gap-2">
              <Shape kind="rhomb" /> −1
            </span>
            <span>−0.5</span>
            <span className="inline gap-2">
              <Shape kind="circle" /> 0
            </span>
            <span>+0.5</span>
            <span className="inline gap-2">
              +1 <Shape kind="box" />
            </span>
          </div>
        </div>
        <NumberField
          aria-label="Sigma, the shape"
          value={formula.sigma}
          min={-1}
          max={1}
          step={0.01}
          show={(value) => fixed(value, 2).replace("−", "-")}
          onChange={(sigma) => change({ sigma }, "sigma")}
        />
      </div>
      <Line
        label="offset"
        title="Offset at the zero crossing"
        value={formula.offset}
        min={0}
        max={Math.max(1, formula.amplitude)}
        step={1}
        onChange={(offset) => change({ offset: Math.min(offset, formula.amplitude) }, "offset")}
        onSettle={onSettle}
      />
      <Line
        label="amplitude"
        title="Amplitude, the largest value"
        value={formula.amplitude}
        min={0}
        max={63}
        step={1}
        onChange={(amplitude) => change({ amplitude, offset: Math.min(formula.offset, amplitude) }, "amplitude")}
        onSettle={onSettle}
      />
      <div className="row wrap gap-8">
        <SegmentedControl
          aria-label="Formula"
          value={formula.method}
          onChange={(method) => change({ method: method as Method }, null)}
          data={[
            { value: "half_rounded_64", label: "½ + 64·f" },
            { value: "63", label: "63·f" },
            { value: "offset", label: "o + (63−o)·f" },
          ]}
        />
        <Switch
          label="fill"
          title="Stretch a box until it reaches the amplitude"
          checked={formula.full_scale}
          onChange={(event) => change({ full_scale: event.currentTarget.checked }, null)}
        />
        <Menu position="bottom-end" width={260}>
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
      <p className={outside ? "m-0 mt-4 caution text-12" : "hint m-0 mt-4"}>
        {outside
          ? "σ is outside the data sheet's range of −0.5 to +0.5 (12.3)."
          : active
            ? "Marked: the data sheet's range of −0.5 to +0.5 (12.3)."
            : "The table is drawn by hand; any change here goes back to the formula."}
      </p>
    </div>
  );
}
