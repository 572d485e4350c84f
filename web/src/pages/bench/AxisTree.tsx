import { Group, Text, UnstyledButton } from "@mantine/core";
import { useEffect, useRef } from "react";
import { Link } from "wouter";
import type { Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { ConditionMark } from "../../lib/condition/ConditionMark";
import { fixed } from "../../lib/format";
import { StateDot } from "../../lib/StateDot";
import { fromSteps, ratesOf, scaleOf, symbolOf } from "../../lib/units";
import { LiveText } from "../../live/LiveText";
import { useStanding } from "../../live/useStanding";
import classes from "./bench.module.css";
import { geometryOf, useCarriage } from "./carriage";
import { emulatedAxis } from "./emulation";
import { Lamps } from "./Lamps";
import { useLiveAxis } from "./live";
import { type EmulatorState, useEmulator } from "./useEmulator";

interface TreeProps {
  devices: readonly Device[];
  selected: { device: string; axis: number } | null;
  unit: string;
  onSelect: (device: string, axis: number) => void;
}

/** From so many axes on a row has one line less: more of them are seen at once. */
const MANY_AXES = 6;

/** Devices and their axes, each with what it does now. It scrolls in itself: what moves and stops stays in sight. */
export function AxisTree({ devices, selected, unit, onSelect }: TreeProps) {
  const many = devices.reduce((count, device) => count + device.axes.length, 0) >= MANY_AXES;
  return (
    <Card as="nav" aria-label="Devices and axes" className={classes.tree} data-many={many}>
      {devices.map((device) => (
        <DeviceGroup key={device.id} device={device} selected={selected} unit={unit} onSelect={onSelect} />
      ))}
    </Card>
  );
}

function DeviceGroup({ device, selected, unit, onSelect }: Omit<TreeProps, "devices"> & { device: Device }) {
  const emulator = useEmulator(device.state === "connected" ? device : undefined);
  return (
    <section className={classes.device} aria-label={device.name}>
      <Group gap={8} wrap="nowrap" className={`${classes.deviceHead} pad`}>
        <StateDot state={device.state} />
        <Text size="sm" fw={600} truncate>
          {device.name}
        </Text>
        <Text size="xs" c="dimmed" truncate ml="auto">
          {device.emulated ? "emulated" : String(device.link.kind ?? "")}
        </Text>
      </Group>
      {device.problem && (
        <Text size="xs" c="red" px="xs" pb={4}>
          {device.problem.detail} <Link href="/connections">Connections</Link>
        </Text>
      )}
      {device.notes.map((note) => (
        <Text key={note} size="xs" px="xs" pb={4} role="status">
          Note: {note}.
        </Text>
      ))}
      {device.axes.length === 0 && (
        <UnstyledButton
          className={`${classes.axis} lit block relative w-full text-13`}
          data-active={selected?.device === device.id}
          aria-pressed={selected?.device === device.id}
          onClick={() => onSelect(device.id, 0)}
        >
          Registers only
        </UnstyledButton>
      )}
      {device.axes.map((axis) => (
        <AxisRow
          key={axis.index}
          device={device}
          axis={axis}
          emulator={emulator.data}
          unit={unit}
          active={selected?.device === device.id && selected.axis === axis.index}
          onSelect={() => onSelect(device.id, axis.index)}
        />
      ))}
    </section>
  );
}

interface RowProps {
  device: Device;
  axis: Device["axes"][number];
  emulator: EmulatorState | undefined;
  unit: string;
  active: boolean;
  onSelect: () => void;
}

function AxisRow({ device, axis, emulator, unit, active, onSelect }: RowProps) {
  const live = useLiveAxis(device.id, axis.index);
  const { condition } = useStanding(device.id, axis.index);
  const row = useRef<HTMLButtonElement>(null);
  useEffect(() => {
    if (active && row.current) bringIntoList(row.current);
  }, [active]);
  const scale = scaleOf(axis, device.clock_hz);
  const known = !Number.isNaN(fromSteps(1, unit, scale, "position"));
  const shown = known ? unit : "microsteps";
  const rate = ratesOf(shown, scale).velocity;
  const decimals = shown === "microsteps" ? 0 : 2;
  return (
    <UnstyledButton
      ref={row}
      className={`${classes.axis} lit grid baseline relative w-full`}
      data-active={active}
      aria-pressed={active}
      onClick={onSelect}
      data-testid={`axis-${device.id}-${axis.index}`}
    >
      <span className={`${classes.axisName} text-13 bold hidden`}>{axis.name}</span>
      <span className={`${classes.axisPosition} text-13 right nowrap`}>
        <LiveText read={() => fixed(fromSteps(live.read("position"), shown, scale, "position"), decimals)} />
        <span className={`${classes.unit} hint inline-block left`}>{symbolOf(shown)}</span>
      </span>
      <Lamps live={live} device={device} />
      <span className={classes.axisWord} title={condition.cause}>
        <ConditionMark kind={condition.kind} />
      </span>
      <span className={`${classes.axisState} text-12 tight right nowrap`}>
        <LiveText read={() => fixed(fromSteps(live.read("velocity"), rate, scale, "velocity"), decimals)} />
        <span className={`${classes.unit} hint inline-block left`}>{symbolOf(rate)}</span>
      </span>
      {device.emulated && (
        <span className={classes.rail} aria-hidden>
          {emulator && <Rail axis={axis} live={live} emulator={emulator} />}
        </span>
      )}
    </UnstyledButton>
  );
}

/** Scrolls the list, and never the page around it, until the row is in sight. */
function bringIntoList(row: HTMLElement): void {
  const list = row.closest("nav");
  if (!list) return;
  const [at, view] = [row.getBoundingClientRect(), list.getBoundingClientRect()];
  if (at.top < view.top) list.scrollTop -= view.top - at.top;
  else if (at.bottom > view.bottom) list.scrollTop += at.bottom - view.bottom;
}

interface RailProps {
  axis: Device["axes"][number];
  live: ReturnType<typeof useLiveAxis>;
  emulator: EmulatorState;
}

/** The stage of an emulated axis as a line: switches, reference, carriage. */
function Rail({ axis, live, emulator }: RailProps) {
  const carriage = useRef<HTMLSpanElement>(null);
  const stage = emulatedAxis(emulator, axis.index);
  useCarriage(live, axis.index, emulator, axis.microsteps_per_full_step, (share) => {
    if (carriage.current) carriage.current.style.left = `${100 * Math.max(0, Math.min(1, share))}%`;
  });
  if (!stage) return null;
  const geometry = geometryOf(stage.places);
  const percent = (share: number) => `${100 * share}%`;
  return (
    <>
      <span
        className={classes.railSpan}
        style={{ left: percent(geometry.left), width: percent(geometry.right - geometry.left) }}
      />
      {geometry.homeFrom !== null && geometry.homeTo !== null && (
        <span
          className={classes.railRef}
          style={{ left: percent(geometry.homeFrom), width: percent(geometry.homeTo - geometry.homeFrom) }}
        />
      )}
      <span ref={carriage} className={classes.railCarriage} />
    </>
  );
}
