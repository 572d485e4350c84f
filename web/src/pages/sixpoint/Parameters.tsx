import { Button, Group, Menu, SegmentedControl } from "@mantine/core";
import { IconChevronDown, IconDownload } from "@tabler/icons-react";
import { Fragment, memo } from "react";
import { compact } from "../../lib/format";
import type { Reach } from "../../lib/ramp/HandleLayer";
import classes from "../../lib/ramp/ramp.module.css";
import { factor, type Units } from "../../lib/ramp/scales";
import { ValueRow } from "../../lib/ramp/ValueRow";
import { Section } from "../../lib/Section";
import type { AxisScale } from "../../lib/units";
import { type Design, KIND, type Lock, MEANING, type Parameter, PRESETS, type Preset } from "./design";
import type { Finding } from "./findings";
import { type Raw, REGISTERS, typedOf, unitOf } from "./registers";

interface Props {
  design: Design;
  raws: Raw;
  onChange: (parameter: Parameter, value: number) => void;
  onPreset: (preset: Preset) => void;
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

/** The registers of the ramp, in the unit of choice and in those of the chip. */
export const Parameters = memo(function Parameters(props: Props) {
  const { scale } = props;
  return (
    <Section
      title="Registers"
      note={<span>clock {compact(scale.clockHz / 1e6)} MHz</span>}
      actions={
        <Group gap={6}>
          <Presets onPreset={props.onPreset} />
          <Button
            size="xs"
            variant="default"
            leftSection={<IconDownload size={14} aria-hidden />}
            disabled={props.onRead === null}
            loading={props.reading}
            title={props.unread}
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
          aria-label="Which values go together"
          value={props.lock}
          onChange={(next) => props.onLock(next as Lock)}
          data={[
            { value: "mirrored", label: "up = down" },
            { value: "free", label: "free" },
          ]}
        />
      </div>
      <div className={classes.table}>
        <div className={classes.heads} data-chip aria-hidden>
          <span>wished</span>
          <span>in the register</span>
        </div>
        {GROUPS.map((group) => (
          <Fragment key={group.title}>
            <h3 className={classes.group}>{group.title}</h3>
            {group.parameters.map((parameter) => (
              <Row key={parameter} parameter={parameter} {...props} />
            ))}
          </Fragment>
        ))}
      </div>
    </Section>
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

function Presets({ onPreset }: { onPreset: (preset: Preset) => void }) {
  return (
    <Menu position="bottom-end" width={330}>
      <Menu.Target>
        <Button size="xs" variant="default" rightSection={<IconChevronDown size={14} aria-hidden />}>
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
