import { NativeSelect, SegmentedControl } from "@mantine/core";
import { useHotkeys, useMediaQuery } from "@mantine/hooks";
import { IconActivity } from "@tabler/icons-react";
import { type ReactNode, useState } from "react";
import type { Device } from "../../../api/queries";
import { EmptyState } from "../../../lib/EmptyState";
import { symbolOf } from "../../../lib/units";
import { Plot } from "../../../plots/Plot";
import type { PlotScale } from "../../../plots/types";
import { ChannelPanel, CursorReadout } from "./ChannelPanel";
import { LinkReadout } from "./LinkReadout";
import type { AxisRef, ScopeRow } from "./model";
import { ScopeToolbar } from "./ScopeToolbar";
import classes from "./scope.module.css";
import { type Trigger, useScopeSettings } from "./settings";
import { type Scope, useScope } from "./useScope";

interface Props {
  devices: readonly Device[];
  main: AxisRef;
  axisName: string;
  /** what stands below the plots, on their time axis */
  children?: (scope: Scope) => ReactNode;
}

const TRIGGERS: readonly Trigger[] = ["roll", "auto", "single"];
const LANE_PX = 92;

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
export function ScopeCard({ devices, main, axisName, children }: Props) {
  const [settings, change] = useScopeSettings();
  const [cursors, setCursors] = useState(false);
  const phone = useMediaQuery("(max-width: 48em)", false, { getInitialValueInEffect: false });
  const [phoneRow, setPhoneRow] = useState("position");
  const scope = useScope(devices, main, settings, cursors);
  const rows = phone ? scope.rows.filter(({ row }) => row.id === phoneRow) : scope.rows;
  const last = rows.at(-1)?.row.id;

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
    <section className={classes.scope} aria-label="Scope" data-testid="scope" data-paused={scope.paused}>
      <div className={classes.head}>
        <ScopeToolbar
          scope={scope}
          devices={devices}
          main={main}
          settings={settings}
          change={change}
          cursors={cursors}
          setCursors={setCursors}
        />
        <div className={classes.links}>
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
        </div>
      </div>
      {cursors && <CursorReadout scope={scope} />}
      {phone && scope.rows.length > 1 && <PlotChoice rows={scope.rows} value={phoneRow} onChange={setPhoneRow} />}
      {rows.length === 0 && (
        <EmptyState title="No plot is chosen" icon={<IconActivity size={22} />}>
          Choose plots with the sliders button above.
        </EmptyState>
      )}
      <div className={classes.rows}>
        {rows.map((scopeRow) => {
          const { row, unit, traces } = scopeRow;
          const bottom = row.id === last;
          return (
            <div
              key={row.id}
              className={classes.row}
              style={
                phone
                  ? undefined
                  : row.grow > 0
                    ? { flexGrow: row.grow, flexBasis: 0 }
                    : { flex: `0 0 ${LANE_PX + (bottom ? 24 : 0)}px` }
              }
            >
              <Plot
                label={`${row.title} of ${axisName} over time${unit ? ` in ${symbolOf(unit)}` : ""}`}
                series={traces.map((trace) => trace.series)}
                x={{ label: "time", unit: "s", axis: bottom }}
                scales={{ y: yScaleOf(scopeRow) }}
                height="100%"
                group="scope"
                legend={false}
                handle={(plot) => scope.setPlot(row.id, plot)}
                overlays={() => scope.overlays(row.id)}
                marks={scope.marks}
                onMark={scope.moveMark}
                onWindow={scope.changeWindow}
                onCursor={(at) => scope.setHover(at?.x ?? null)}
              />
              <ChannelPanel scopeRow={scopeRow} scope={scope} cursors={cursors} onToggle={toggle} />
            </div>
          );
        })}
      </div>
      {children?.(scope)}
    </section>
  );
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
    return (
      <SegmentedControl size="xs" fullWidth aria-label="Which plot" data={data} value={value} onChange={onChange} />
    );
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
