import { Button, Group, Menu, SegmentedControl, Switch } from "@mantine/core";
import { IconChevronDown, IconDownload } from "@tabler/icons-react";
import { Fragment, memo } from "react";
import { compact } from "../../lib/format";
import type { Answer } from "../../lib/ramp/answer";
import type { Reach } from "../../lib/ramp/HandleLayer";
import classes from "../../lib/ramp/ramp.module.css";
import { factor, type Units } from "../../lib/ramp/scales";
import { ValueRow } from "../../lib/ramp/ValueRow";
import { Section } from "../../lib/Section";
import type { AxisScale } from "../../lib/units";
import {
  type Design,
  KIND,
  type Lock,
  MEANING,
  type Options,
  type Parameter,
  PRESETS,
  type Preset,
  type Shape,
  used,
} from "./design";

interface Props {
  design: Design;
  onChange: (parameter: Parameter, value: number) => void;
  onPreset: (preset: Preset) => void;
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

/** The registers of the ramp in the unit of choice, and what their fixed point makes of them. */
export const Parameters = memo(function Parameters(props: Props) {
  const { lock, onLock, options, onOptions, scale } = props;
  const shown = used(options);
  return (
    <Section
      title="Registers"
      note={<span>clock {compact(scale.clockHz / 1e6)} MHz</span>}
      actions={
        <Group gap={6}>
          <Presets onPreset={props.onPreset} disabled={options.shape !== "s"} />
          <Button
            size="xs"
            variant="default"
            leftSection={<IconDownload size={14} aria-hidden />}
            disabled={props.onRead === null}
            loading={props.reading}
            onClick={() => props.onRead?.()}
          >
            Read from chip
          </Button>
        </Group>
      }
    >
      <div className={classes.choices}>
        <SegmentedControl
          size="xs"
          aria-label="Shape of the ramp"
          value={options.shape}
          onChange={(shape) => onOptions({ shape: shape as Shape })}
          data={[
            { value: "s", label: "S-ramp" },
            { value: "trapezoid", label: "trapezoid" },
            { value: "hold", label: "hold" },
          ]}
        />
        <SegmentedControl
          size="xs"
          aria-label="Which values go together"
          value={lock}
          disabled={options.shape === "hold"}
          onChange={(next) => onLock(next as Lock)}
          data={[
            { value: "equal", label: "all equal" },
            { value: "mirrored", label: "up = down" },
            { value: "free", label: "free" },
          ]}
        />
      </div>
      <div className={classes.table}>
        <div className={classes.heads} aria-hidden>
          <span>wished</span>
          <span>in the register</span>
        </div>
        {GROUPS.map((group) => {
          const parameters = group.parameters.filter((parameter) => shown.includes(parameter));
          return (
            parameters.length > 0 && (
              <Fragment key={group.title}>
                <h3 className={classes.group}>{group.title}</h3>
                {parameters.map((parameter) => (
                  <Row key={parameter} parameter={parameter} {...props} />
                ))}
              </Fragment>
            )
          );
        })}
      </div>
      <div className={classes.switches}>
        {options.shape === "s" && (
          <Switch
            size="xs"
            label="start with ASTART after VSTART"
            description="use_astart_and_vstart"
            checked={options.useAstart}
            onChange={(event) => onOptions({ useAstart: event.currentTarget.checked })}
          />
        )}
        {options.shape !== "hold" && (
          <Switch
            size="xs"
            label="accelerations per clock²"
            description="direct_acc_val_en: for short, steep ramps"
            checked={options.directAcceleration}
            onChange={(event) => onOptions({ directAcceleration: event.currentTarget.checked })}
          />
        )}
        {options.shape === "s" && (
          <Switch
            size="xs"
            label="bows per clock³"
            description="direct_bow_val_en: bows above 16.8 Mpps³"
            checked={options.directBow}
            onChange={(event) => onOptions({ directBow: event.currentTarget.checked })}
          />
        )}
      </div>
    </Section>
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

function Presets({ onPreset, disabled }: { onPreset: (preset: Preset) => void; disabled: boolean }) {
  return (
    <Menu position="bottom-end" width={330}>
      <Menu.Target>
        <Button
          size="xs"
          variant="default"
          disabled={disabled}
          rightSection={<IconChevronDown size={14} aria-hidden />}
        >
          Presets
        </Button>
      </Menu.Target>
      <Menu.Dropdown>
        {PRESETS.map((preset) => (
          <Menu.Item key={preset.name} onClick={() => onPreset(preset)}>
            {preset.name}
            <span className={classes.presetText}>{preset.text}</span>
          </Menu.Item>
        ))}
      </Menu.Dropdown>
    </Menu>
  );
}
