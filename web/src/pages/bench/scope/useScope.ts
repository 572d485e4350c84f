import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { can, type Device } from "../../../api/queries";
import { fixed } from "../../../lib/format";
import { Shared } from "../../../lib/shared";
import { useScheme } from "../../../lib/useScheme";
import { hub } from "../../../live/hub";
import type { TelemetrySource } from "../../../live/TelemetrySource";
import { useFrame } from "../../../live/useFrame";
import { useLinks, useTelemetries } from "../../../live/useTelemetry";
import { cut, ROWS_PER_PIXEL, type Trace } from "../../../live/window";
import { type PlotData, resampled } from "../../../plots/series";
import type { Level, Mark, Overlay, PlotHandle, WindowChange } from "../../../plots/types";
import { flagsOf } from "../../recordings/flags";
import type { Samples } from "./free/feed";
import type { Told } from "./free/ToldMarks";
import { type AxisRef, buildRows, requestsFor, type ScopeRow, type ScopeTrace } from "./model";
import { PredictionKeeper } from "./predictions";
import type { RowId } from "./rows";
import { ScopeView } from "./ScopeView";
import type { ScopeSettings } from "./settings";

/** A channel of a plot in step with the scope, besides those of its rows: what the cursors' table measures. */
export interface Measured {
  key: string;
  label: string;
  unit: string;
  samples: (window: readonly [number, number]) => Samples;
}

const MARK_COLORS = { light: { a: "#b5179e", b: "#3a0ca3" }, dark: { a: "#f072c8", b: "#9d8cff" } };

/** What to add to a device's time to get that of a source [s]; 0 while one of them has not told when it began. */
export function shiftTo(source: TelemetrySource, device: string): number {
  const [theirs, own] = [hub.sourceOf(device).link().timeOriginUnixS, source.link().timeOriginUnixS];
  return theirs === null || own === null ? 0 : theirs - own;
}

/** The strip below the plots that has their time axis. */
export const TIME_AXIS = "time";

/** Everything that moves on the scope: samples to plots in every frame, outside of React's rendering. */
export function useScope(devices: readonly Device[], main: AxisRef, settings: ScopeSettings, cursors: boolean) {
  const scheme = useScheme();
  const requests = useMemo(() => requestsFor(devices, main, settings), [devices, main, settings]);
  const sources = useTelemetries(requests);
  const links = useLinks(sources);
  // By content: the list of devices is new once a second, and the plots are to stay.
  const built = buildRows(devices, main, settings, scheme);
  const shape = JSON.stringify(built);
  // biome-ignore lint/correctness/useExhaustiveDependencies: `shape` is `built`, compared by content
  const rows = useMemo(() => built, [shape]);
  const [view] = useState(() => new ScopeView(settings.spanS, settings.trigger));
  const [paused, setPaused] = useState(false);
  const plots = useRef(new Map<RowId | typeof TIME_AXIS, PlotHandle>());
  const hover = useRef<number | null>(null);
  const now = useRef<{ overlays: Map<RowId, Overlay[]> }>({ overlays: new Map() });
  const keeper = useMemo(() => new PredictionKeeper(main.device, main.axis), [main.device, main.axis]);
  const source = sources[0];
  const mainDevice = devices.find(({ id }) => id === main.device);
  const told = useRef<readonly Told[]>([]);
  const compares = can(mainDevice, "position_compare") && mainDevice?.state === "connected";
  const [compared, setCompared] = useState<number | null>(null);

  useEffect(() => view.set(settings.spanS, settings.trigger), [view, settings.spanS, settings.trigger]);

  const run = useCallback(() => {
    view.run();
    setPaused(false);
  }, [view]);
  const pause = useCallback(
    (window?: readonly [number, number]) => {
      view.pause(sources, window);
      setPaused(true);
    },
    [view, sources],
  );

  // Another axis is another time: what was paused or caught belongs to the one before.
  // biome-ignore lint/correctness/useExhaustiveDependencies: the axis is what the view looks at
  useEffect(run, [run, main.device, main.axis]);

  const moves = mainDevice?.axes.length !== 0;
  useEffect(() => {
    if (!moves) return;
    void keeper.fetch();
    return source?.on("move", (move) => {
      if (move.axis !== main.axis) return;
      void keeper.fetch();
      view.onMove(move.started_at_s, source.buffer.lastTime);
    });
  }, [moves, source, keeper, view, main.axis]);

  const sourceOf = useCallback(
    (trace: ScopeTrace) => sources.find((candidate) => candidate.request.device === trace.device),
    [sources],
  );

  /** What to add to a device's time to get the main one's [s]. */
  const shiftOf = useCallback((device: string): number => (source ? shiftTo(source, device) : 0), [source]);

  /** The raw value of a trace at a time of the main device; the newest where none is given. */
  const valueAt = useCallback(
    (trace: ScopeTrace, time: number | null): number => {
      const from = sourceOf(trace);
      if (!from) return Number.NaN;
      const buffer = view.bufferOf(from);
      return time === null ? buffer.last(trace.channel) : buffer.at(trace.channel, time - shiftOf(trace.device));
    },
    [sourceOf, shiftOf, view],
  );

  const [measured] = useState(() => new Map<string, readonly Measured[]>());

  const drawn = useRef("");
  useFrame((nowMs) => {
    if (!source) return;
    const buffer = view.bufferOf(source);
    const { window, complete } = view.next(source.buffer.lastTime, nowMs);
    if (complete) {
      pause();
      return;
    }
    const predicted = predictedOverlays(rows, buffer.lastTime, buffer.last(`predicted_position.${main.axis}`), nowMs);
    const revision = sources.map((each) => view.bufferOf(each).revision).join();
    const state = `${window.join()} ${revision} ${view.revision} ${shape.length} ${predicted} ${cursors} ${source.program.at(-1)?.time_s} ${told.current.length}`;
    if (drawn.current === state && !fresh.current) return;
    drawn.current = state;
    fresh.current = false;
    for (const { row, traces } of rows) {
      const plot = plots.current.get(row.id);
      const width = plot?.uplot?.over.clientWidth ?? 0;
      if (!plot || width === 0) continue;
      plot.setData(dataOf(traces, window, width * ROWS_PER_PIXEL), window);
    }
    plots.current.get(TIME_AXIS)?.setData([window], window);
  });
  // a new set of plots has drawn nothing yet
  const fresh = useRef(true);
  // biome-ignore lint/correctness/useExhaustiveDependencies: what makes the plots anew
  useEffect(() => {
    fresh.current = true;
  }, [rows, cursors]);

  function dataOf(traces: readonly ScopeTrace[], window: readonly [number, number], mostRows: number): PlotData {
    if (!source) return [[], ...traces.map(() => [])];
    const specs = traces.map(
      (trace): Trace => ({ channel: trace.channel, divisor: trace.divisor, offset: trace.offset }),
    );
    const own = cut(view.bufferOf(source), specs, window[0], window[1], mostRows);
    const columns = own.columns.map((column, index) => {
      const trace = traces[index] as ScopeTrace;
      const other = sourceOf(trace);
      if (!other || other === source) return column;
      const shift = shiftOf(trace.device);
      const spec = specs[index] as Trace;
      const theirs = cut(view.bufferOf(other), [spec], window[0] - shift, window[1] - shift, mostRows);
      const spacing = own.x.length > 1 ? (window[1] - window[0]) / own.x.length : 0;
      const reach = Math.max(2.5 / other.request.rateHz, 3 * spacing);
      return resampled(own.x, theirs.x, theirs.columns[0] ?? [], shift, reach);
    });
    return [own.x, ...columns];
  }

  /** Puts what is still to come of the predicted ramp over the plots. Returns a number that changes with it. */
  function predictedOverlays(shown: readonly ScopeRow[], newestS: number, predictedNow: number, nowMs: number): number {
    const ramp = keeper.inForce(newestS, predictedNow, nowMs);
    now.current.overlays.clear();
    if (!ramp) return 0;
    const from = Math.max(0, ramp.time.findIndex((time) => time + ramp.startedAtS >= newestS) - 1);
    for (const { row, traces } of shown) {
      const quantity = row.id === "position" ? "predicted_position" : row.id === "velocity" ? "predicted_velocity" : "";
      const trace = traces.find((candidate) => candidate.quantity === quantity && candidate.shown);
      if (!trace) continue;
      const column = (row.id === "position" ? ramp.position : ramp.velocity).subarray(from);
      now.current.overlays.set(row.id, [
        {
          x: ramp.time.subarray(from),
          y: column.map((value) => value / trace.divisor),
          shift: ramp.startedAtS,
          color: trace.series.color,
          width: 5,
        },
      ]);
    }
    return ramp.startedAtS + from;
  }

  /** Where the chip tells that the axis comes by. */
  const levels = ({ row, traces }: ScopeRow): readonly Level[] => {
    const position = traces.find(({ quantity, main: own }) => own && quantity === "position");
    if (row.id !== "position" || compared === null || !position) return [];
    const { color } = position.series;
    return [{ id: "compare", y: compared / position.divisor, color, label: "compare", fixed: true }];
  };
  /** What was told in the window on show, `named` in words too, where it was triggered, and the cursors. */
  const marks = useCallback(
    (named: boolean) => (): readonly Mark[] => {
      const colors = MARK_COLORS[scheme];
      const done = (source?.program ?? []).map(({ time_s, text }) => ({ time_s, text, kind: "program" }));
      const all = [...done, ...told.current];
      const at = view.triggerTime;
      const trigger: Mark[] = at === null ? [] : [{ id: "t", x: at, color: "#7a828c", label: "T", fixed: true }];
      const flags = all.length === 0 ? [] : flagsOf(all, 0, scheme)(view.current(), named);
      const { a, b } = view.cursors();
      const cursor: Mark[] = [
        { id: "a", x: a, color: colors.a, label: "A" },
        { id: "b", x: b, color: colors.b, label: "B" },
      ];
      return [...flags, ...trigger, ...(cursors ? cursor : [])];
    },
    [view, source, scheme, cursors],
  );

  return {
    rows,
    view,
    links,
    sources,
    paused,
    run,
    pause,
    valueAt,
    sourceOf,
    shiftOf,
    measured,
    told,
    compares,
    setCompared,
    marks,
    levels,
    markColors: MARK_COLORS[scheme],
    overlays: (row: RowId): readonly Overlay[] => now.current.overlays.get(row) ?? [],
    /** the latest thing that was told, as its mark says it */
    latestTold: (): string => {
      const latest = [...(source?.program ?? []), ...told.current]
        .sort((one, other) => one.time_s - other.time_s)
        .at(-1);
      return latest ? `${latest.text} (${fixed(latest.time_s, 3, "s")})` : "";
    },
    hover: () => hover.current,
    setHover: (time: number | null) => {
      hover.current = time;
    },
    moveMark: (id: string, time: number) => {
      view.moveCursor(id === "a" ? "a" : "b", time);
    },
    /** A zoom or pan by hand holds the picture; "show all" goes back to following the signal. */
    changeWindow: (change: WindowChange): boolean => {
      if (change === "reset") run();
      else pause([change.min, change.max]);
      return true;
    },
    /** where the plots have their time axis, in pixels of the page; null while there is none */
    timeBox: (): { left: number; width: number } | null => {
      for (const plot of plots.current.values()) {
        const box = plot.uplot?.over.getBoundingClientRect();
        if (box && box.width > 0) return { left: box.left, width: box.width };
      }
      return null;
    },
    setPlot: (row: RowId | typeof TIME_AXIS, plot: PlotHandle | null) => {
      if (plot) {
        plots.current.set(row, plot);
        fresh.current = true;
      } else plots.current.delete(row);
    },
  };
}

export type Scope = ReturnType<typeof useScope>;

/** The scope on the page: what else shows time keeps in step with it. */
export const SCOPE = new Shared<Scope | null>(null);
