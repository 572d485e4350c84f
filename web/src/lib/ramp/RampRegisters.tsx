import { Button, Group, Menu, SegmentedControl } from "@mantine/core";
import { IconChevronDown, IconDownload } from "@tabler/icons-react";
import { Fragment, type ReactNode } from "react";
import { Card } from "../Card";
import { compact } from "../format";
import classes from "./ramp.module.css";

export interface Preset<Design> {
  name: string;
  text: string;
  of: (design: Design) => Design;
}

interface Props<Parameter extends string, Lock extends string, Shape> {
  clockHz: number;
  presets: readonly Preset<Shape>[];
  /** null where they do not fit this ramp */
  onPreset: ((preset: Preset<Shape>) => void) | null;
  /** null where there is nothing to read */
  onRead: (() => void) | null;
  /** why, where a chip is there */
  unread?: string;
  reading: boolean;
  /** choices before the one of which values go together */
  choices?: ReactNode;
  locks: readonly { value: Lock; label: string }[];
  lock: Lock;
  /** null where nothing goes together */
  onLock: ((lock: Lock) => void) | null;
  groups: readonly { title: string; parameters: readonly Parameter[] }[];
  /** of these only; all where it is left out */
  used?: readonly Parameter[];
  /** the register's own number is typed as well */
  typed?: boolean;
  row: (parameter: Parameter) => ReactNode;
  /** below the registers */
  children?: ReactNode;
}

/** The registers of a ramp by group, with what fills them at once: presets and the chip's own values. */
export function RampRegisters<Parameter extends string, Lock extends string, Shape>(
  props: Props<Parameter, Lock, Shape>,
) {
  const { onPreset, onRead, onLock, locks, used } = props;
  const groups = props.groups.map(({ title, parameters }) => ({
    title,
    parameters: parameters.filter((parameter) => used?.includes(parameter) ?? true),
  }));
  return (
    <Card
      title="Registers"
      note={<span>clock {compact(props.clockHz / 1e6, 4, "MHz")}</span>}
      actions={
        <Group gap={6}>
          <Menu position="bottom-end" width={330}>
            <Menu.Target>
              <Button
                variant="default"
                disabled={onPreset === null}
                rightSection={<IconChevronDown size={14} aria-hidden />}
              >
                Presets
              </Button>
            </Menu.Target>
            <Menu.Dropdown>
              {props.presets.map((preset) => (
                <Menu.Item key={preset.name} onClick={() => onPreset?.(preset)}>
                  {preset.name}
                  <span className="hint block tight">{preset.text}</span>
                </Menu.Item>
              ))}
            </Menu.Dropdown>
          </Menu>
          <Button
            variant="default"
            leftSection={<IconDownload size={14} aria-hidden />}
            disabled={onRead === null}
            loading={props.reading}
            title={props.unread}
            onClick={() => onRead?.()}
          >
            Read from chip
          </Button>
        </Group>
      }
    >
      <div className="flex wrap gap-6 mb-4">
        {props.choices}
        <SegmentedControl
          aria-label="Which values go together"
          value={props.lock}
          disabled={onLock === null}
          onChange={(next) => onLock?.(next)}
          data={[...locks]}
        />
      </div>
      <div className="grid gap-4">
        <div className={`${classes.row} hint`} data-chip={props.typed} aria-hidden>
          <span />
          <span>wished</span>
          <span>in the register</span>
        </div>
        {groups.map(
          ({ title, parameters }) =>
            parameters.length > 0 && (
              <Fragment key={title}>
                <h3 className="hint m-0 mt-4 bold">{title}</h3>
                {parameters.map((parameter) => (
                  <Fragment key={parameter}>{props.row(parameter)}</Fragment>
                ))}
              </Fragment>
            ),
        )}
      </div>
      {props.children}
    </Card>
  );
}
