import { NativeSelect, SegmentedControl, Text } from "@mantine/core";
import { useHotkeys, useMediaQuery } from "@mantine/hooks";
import { IconActivity } from "@tabler/icons-react";
import { type ReactNode, useEffect, useLayoutEffect, useRef, useState } from "react";
import type { Device } from "../../../api/queries";
import { useAddress } from "../../../lib/address";
import { Card } from "../../../lib/Card";
import { EmptyState } from "../../../lib/EmptyState";
import { later } from "../../../lib/later";
import { symbolOf } from "../../../lib/units";
import { LiveText } from "../../../live/LiveText";
import { Plot } from "../../../plots/Plot";
import type { PlotScale } from "../../../plots/types";
import { ChannelPanel, CursorReadout } from "./ChannelPanel";
import { FoldedPlots } from "./FoldedPlots";
import { foldedRows, leastHeight, TIME_AXIS_PX } from "./folding";
import { LinkReadout } from "./LinkReadout";
import type { AxisRef, ScopeRow } from "./model";
import type { RowId } from "./rows";
import { ScopeToolbar } from "./ScopeToolbar";
import classes from "./scope.module.css";
import { isStretch, type ScopeSettings, type Trigger } from "./settings";
import { SCOPE, type Scope, TIME_AXIS, useScope } from "./useScope";

const ComparedCount = later(() => import("./ComparedCount").then((part) => part.ComparedCount));
const FreePlots = later(() => import("./free/FreePlots").then((part) => part.FreePlots));
const ChannelTree = later(() => import("./free/ChannelTree").then((part) => part.ChannelTree));
const CursorFigures = later(() => import("./free/CursorTable").then((part) => part.CursorFigures));
const StretchInAddress = later(() => import("./free/StretchInAddress").then((part) => part.StretchInAddress));
const ToldMarks = later(() => import("./free/ToldMarks").then((part) => part.ToldMarks), false);

interface Props {
  devices: readonly Device[];
  main: AxisRef;
  axisName: string;
  /** what it shows; whoever keeps that also keeps what `change` says */
  settings: ScopeSettings;
  change: (part: Partial<ScopeSettings>) => void;
  /** what stands below the plots, on their time axis */
  children?: (scope: Scope) => ReactNode;
}

const TRIGGERS: readonly Trigger[] = ["roll", "auto", "single"];
const NO_SERIES = [] as const;
/** the least height of a plot that the user has put together */
const FREE_PX = 134;

function yScaleOf({ row, unit, traces }: ScopeRow): PlotScale {
  if (row.id === "switches") {
    const count = row.channels.length;
    return {
      range: [0, count],
      at: row.channels.map((_, index) => count - 0.5 - index),
      ticks: (values) =>
        values.map((value) => {
          const channel = row.channels[Math.round(count - 0.5 - value)];
          return traces.some((trace) => trace.quantity === channel?.quantity) ? (channel?.label ?? "") : "";
        }),
    };
  }
  return row.id === "position" ? { unit } : { unit, include: [0] };
}

/** The scope: what the selected axis does, against what it was to do. */
export function ScopeCard({ devices, main, axisName, settings, change, children }: Props) {
  const [cursors, setCursors] = useState(false);
  const [tree, setTree] = useState(false);
  const phone = useMediaQuery("(max-width: 48em)", false, { getInitialValueInEffect: false });
  const [phoneRow, setPhoneRow] = useState("position");
  const scope = useScope(devices, main, settings, cursors);
  useEffect(() => SCOPE.set(scope));
  useEffect(() => () => SCOPE.set(null), []);
  const stretch = isStretch(useAddress("t").t);
  const [box, heightPx] = useHeight();
  const folded: ReadonlySet<RowId> =
    phone || heightPx === null
      ? new Set()
      : foldedRows(scope.rows, heightPx - settings.free.length * FREE_PX, settings.folds, cursors);
  const rows = scope.rows.filter(({ row }) => (phone ? row.id === phoneRow : !folded.has(row.id)));
  const fold = (id: RowId, on: boolean) => change({ folds: { ...settings.folds, [id]: on } });

  useHotkeys([
    ["p", () => (scope.paused ? scope.run() : scope.pause())],
    ["c", () => setCursors((on) => !on)],
    [
      "t",
      () => {
        change({ trigger: TRIGGERS[(TRIGGERS.indexOf(settings.trigger) + 1) % TRIGGERS.length] ?? "roll" });
        scope.run();
      },
    ],
  ]);

  const toggle = (key: string) =>
    change({
      hidden: settings.hidden.includes(key)
        ? settings.hidden.filter((hidden) => hidden !== key)
        : [...settings.hidden, key],
    });

  return (
    <Card
      className={`${classes.scope} stack grow shrink gap-6`}
      aria-label="Scope"
      data-testid="scope"
      data-paused={scope.paused}
    >
      <div className="mid lines-16 between">
        <ScopeToolbar
          scope={scope}
          devices={devices}
          main={main}
          settings={settings}
          change={change}
          cursors={cursors}
          setCursors={setCursors}
          tree={tree}
          setTree={setTree}
        />
        <div className="stack shrink">
          {scope.sources.map((source, index) => {
            const link = scope.links[index];
            return (
              link && (
                <LinkReadout
                  key={source.request.device}
                  name={devices.find((device) => device.id === source.request.device)?.name ?? source.request.device}
                  several={scope.sources.length > 1}
                  link={link}
                />
              )
            );
          })}
          <LiveText className="num hint" data-testid="program-mark" read={scope.latestTold} />
        </div>
      </div>
      {cursors && (
        <div className="lines-8 mid">
          <CursorReadout scope={scope} />
          <CursorFigures scope={scope} />
        </div>
      )}
      {phone && scope.rows.length > 1 && <PlotChoice rows={scope.rows} value={phoneRow} onChange={setPhoneRow} />}
      {scope.rows.length === 0 && settings.free.length === 0 && (
        <EmptyState title="No plot is chosen" icon={<IconActivity size={22} />}>
          <Text size="sm" className="dim">
            The sliders button above has plots, registers and parameters.
          </Text>
        </EmptyState>
      )}
      <div className={classes.body}>
        <div ref={box} className={`${classes.rows} stack gap-2`}>
          {rows.map((scopeRow, index) => {
            const { row, unit, traces } = scopeRow;
            const px = leastHeight(scopeRow, cursors);
            return (
              <div
                key={row.id}
                className={classes.row}
                style={phone ? undefined : { flex: row.grow > 0 ? `${row.grow} 0 ${px}px` : `0 0 ${px}px` }}
              >
                <Plot
                  label={`${row.title} of ${axisName} over time${unit ? ` in ${symbolOf(unit)}` : ""}`}
                  series={traces.map((trace) => trace.series)}
                  x={{ label: "time", unit: "s", axis: phone === true }}
                  scales={{ y: yScaleOf(scopeRow) }}
                  height="100%"
                  group="scope"
                  legend={false}
                  handle={(plot) => scope.setPlot(row.id, plot)}
                  overlays={() => scope.overlays(row.id)}
                  levels={scope.levels(scopeRow)}
                  marks={scope.marks(index === 0)}
                  onMark={scope.moveMark}
                  onWindow={scope.changeWindow}
                  onCursor={(at) => scope.setHover(at?.x ?? null)}
                />
                <ChannelPanel
                  scopeRow={scopeRow}
                  scope={scope}
                  cursors={cursors}
                  onToggle={toggle}
                  {...(phone || scope.rows.length === 1 ? {} : { onFold: () => fold(row.id, true) })}
                />
              </div>
            );
          })}
          {settings.free.length > 0 && (
            <FreePlots scope={scope} devices={devices} settings={settings} change={change} />
          )}
          {!phone && rows.length + settings.free.length > 0 && (
            <div className={classes.timeAxis} data-testid="time-axis">
              <Plot
                label="Time"
                scenery
                series={NO_SERIES}
                x={{ label: "time", unit: "s" }}
                height={TIME_AXIS_PX}
                group="scope"
                handle={(plot) => scope.setPlot(TIME_AXIS, plot)}
              />
            </div>
          )}
          {folded.size > 0 && (
            <FoldedPlots
              rows={scope.rows.filter(({ row }) => folded.has(row.id))}
              scope={scope}
              onOpen={(id) => fold(id, false)}
            />
          )}
        </div>
        {tree && <ChannelTree devices={devices} settings={settings} change={change} onClose={() => setTree(false)} />}
      </div>
      {(scope.paused || stretch) && (
        <StretchInAddress scope={scope} settings={settings} cursors={cursors} setCursors={setCursors} />
      )}
      {scope.compares && <ComparedCount at={main} onCount={scope.setCompared} />}
      {settings.marks && <ToldMarks device={main.device} axis={main.axis} scope={scope} />}
      {children?.(scope)}
    </Card>
  );
}

/** The height of a box that others make as high as it is [px]; null before it is there. */
function useHeight() {
  const box = useRef<HTMLDivElement>(null);
  const [heightPx, setHeightPx] = useState<number | null>(null);
  useLayoutEffect(() => {
    const node = box.current;
    if (!node) return;
    const measure = () => setHeightPx(node.clientHeight);
    measure();
    const observer = new ResizeObserver(measure);
    observer.observe(node);
    return () => observer.disconnect();
  }, []);
  return [box, heightPx] as const;
}

/** Side by side a phone has room for five names. */
const SIDE_BY_SIDE = 5;

interface ChoiceProps {
  rows: readonly ScopeRow[];
  value: string;
  onChange: (id: string) => void;
}

function PlotChoice({ rows, value, onChange }: ChoiceProps) {
  const data = rows.map(({ row }) => ({ value: row.id, label: row.id === "acceleration" ? "Accel." : row.title }));
  if (rows.length <= SIDE_BY_SIDE)
    return <SegmentedControl fullWidth aria-label="Which plot" data={data} value={value} onChange={onChange} />;
  return (
    <NativeSelect
      size="sm"
      aria-label="Which plot"
      data={data}
      value={value}
      onChange={(event) => onChange(event.currentTarget.value)}
    />
  );
}
