import { ActionIcon, Box, Button, Group, Popover, SegmentedControl } from "@mantine/core";
import {
  IconAdjustmentsHorizontal,
  IconListTree,
  IconPlayerPause,
  IconPlayerPlay,
  IconRulerMeasure,
} from "@tabler/icons-react";
import type { Device } from "../../../api/queries";
import { Choice } from "../../../lib/Choice";
import { namesOf, optionsOf } from "../../../lib/choices";
import { later } from "../../../lib/later";
import { scaleOf, symbolOf, unitsFor } from "../../../lib/units";
import { LiveText } from "../../../live/LiveText";
import { RecordButton } from "../../recordings/RecordButton";
import { type AxisRef, rowsOf } from "./model";
import { furtherOf, type RowId } from "./rows";
import classes from "./scope.module.css";
import { keepS, RATES_HZ, type ScopeSettings, SPANS_S, type Trigger } from "./settings";
import type { Scope } from "./useScope";

const ScopeChoices = later(() => import("./ScopeChoices").then((part) => part.ScopeChoices));

interface Props {
  scope: Scope;
  devices: readonly Device[];
  main: AxisRef;
  settings: ScopeSettings;
  change: (part: Partial<ScopeSettings>) => void;
  cursors: boolean;
  setCursors: (on: boolean) => void;
  /** the channels beside the plots */
  tree: boolean;
  setTree: (on: boolean) => void;
}

function spanLabel(seconds: number): string {
  if (seconds < 1) return `${seconds * 1000} ms`;
  return seconds < 60 ? `${seconds} s` : `${seconds / 60} min`;
}

/** Run and pause, trigger, time base, rate, units, cursors, channels. */
export function ScopeToolbar({ scope, devices, main, settings, change, cursors, setCursors, tree, setTree }: Props) {
  const device = devices.find((candidate) => candidate.id === main.device);
  const scale = scaleOf(
    device?.axes.find((axis) => axis.index === main.axis),
    device?.clock_hz,
  );
  const units = unitsFor("position", scale);
  const rates = RATES_HZ.filter((rate) => rate <= (device?.rate_max_hz ?? 1000));
  const names = namesOf(devices);
  const others = devices.flatMap((candidate) =>
    candidate.axes
      .filter((axis) => candidate.id !== main.device || axis.index !== main.axis)
      .map((axis) => ({ device: candidate.id, axis: axis.index, label: `${names.get(candidate.id)} · ${axis.name}` })),
  );
  const isExtra = (ref: AxisRef) =>
    settings.extras.some((extra) => extra.device === ref.device && extra.axis === ref.axis);
  const toggleRow = (id: RowId) =>
    change({
      rows: settings.rows.includes(id) ? settings.rows.filter((row) => row !== id) : [...settings.rows, id],
    });
  const toggleExtra = (ref: AxisRef) =>
    change({
      extras: isExtra(ref)
        ? settings.extras.filter((extra) => extra.device !== ref.device || extra.axis !== ref.axis)
        : [...settings.extras, { device: ref.device, axis: ref.axis }],
    });

  return (
    <Group gap={6} className="shrink" role="toolbar" aria-label="Scope">
      <Button
        w={92}
        variant={scope.paused ? "filled" : "default"}
        leftSection={
          scope.paused ? <IconPlayerPlay size={15} aria-hidden /> : <IconPlayerPause size={15} aria-hidden />
        }
        onClick={() => (scope.paused ? scope.run() : scope.pause())}
        aria-keyshortcuts="P"
        title="P"
      >
        {scope.paused ? "Run" : "Pause"}
      </Button>
      <SegmentedControl
        aria-label="Trigger"
        data={optionsOf({ roll: "Roll", auto: "Auto", single: "Single" })}
        value={settings.trigger}
        onChange={(value) => {
          change({ trigger: value as Trigger });
          scope.run();
        }}
        title="Roll: follow the signal. Auto: a sweep from every start of a move. Single: catch the next move and hold (T)"
      />
      <Choice
        w={86}
        aria-label="Time span"
        data={SPANS_S.filter((span) => span <= keepS(settings.rateHz)).map((span) => ({
          value: String(span),
          label: spanLabel(span),
        }))}
        value={String(settings.spanS)}
        onChange={(value) => change({ spanS: Number(value) })}
      />
      <Choice
        w={92}
        className={classes.roomy ?? ""}
        aria-label="Sample rate"
        data={rates.map((rate) => ({ value: String(rate), label: `${rate} Hz` }))}
        value={String(rates.findLast((rate) => rate <= settings.rateHz) ?? rates[0])}
        onChange={(value) => {
          const rateHz = Number(value);
          change({ rateHz, spanS: Math.min(settings.spanS, keepS(rateHz)) });
        }}
      />
      <Choice
        w={96}
        className={classes.roomy ?? ""}
        aria-label="Unit of positions"
        data={units.map((unit) => ({ value: unit, label: symbolOf(unit) }))}
        value={units.includes(settings.unit) ? settings.unit : "microsteps"}
        onChange={(value) => change({ unit: value })}
      />
      <ActionIcon
        color="accent"
        variant={cursors ? "filled" : "default"}
        size={30}
        aria-label="Measuring cursors"
        aria-pressed={cursors}
        aria-keyshortcuts="C"
        title="Measuring cursors (C)"
        onClick={() => {
          if (!cursors) scope.view.fetchCursors();
          setCursors(!cursors);
        }}
      >
        <IconRulerMeasure size={17} />
      </ActionIcon>
      <Popover position="bottom-start" shadow="md">
        <Popover.Target>
          <ActionIcon variant="default" size={30} aria-label="Plots and further axes" title="Plots and further axes">
            <IconAdjustmentsHorizontal size={17} />
          </ActionIcon>
        </Popover.Target>
        <Popover.Dropdown>
          <ScopeChoices
            rows={rowsOf(device, main.axis).map(({ id, title }) => ({
              label: title,
              chosen: settings.rows.includes(id),
              toggle: () => toggleRow(id),
            }))}
            marks={settings.marks}
            onMarks={(marks) => change({ marks })}
            further={furtherOf(device, main.axis)}
            more={settings.more}
            onMore={(more) => change({ more })}
            others={others.map((ref) => ({ label: ref.label, chosen: isExtra(ref), toggle: () => toggleExtra(ref) }))}
          />
        </Popover.Dropdown>
      </Popover>
      <ActionIcon
        color="accent"
        variant={tree ? "filled" : "default"}
        size={30}
        aria-label="Channels and plots of your own"
        aria-pressed={tree}
        title="Channels of all devices, into plots of your own"
        onClick={() => setTree(!tree)}
      >
        <IconListTree size={17} />
      </ActionIcon>
      {device && (
        <Box component="span" miw={30}>
          <RecordButton device={device} axis={main.axis} rateHz={settings.rateHz} further={settings.more} />
        </Box>
      )}
      <LiveText
        className="accent text-12 bold"
        read={() => (scope.view.waiting ? "waiting for a move" : "")}
        aria-hidden
      />
    </Group>
  );
}
