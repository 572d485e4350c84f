import { ActionIcon, Select, Text } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { type DragEvent, memo, useEffect, useId, useMemo, useRef, useState } from "react";
import type { Device } from "../../../../api/queries";
import { compact } from "../../../../lib/format";
import { colorOf, lineOf } from "../../../../lib/palette";
import { useLatest } from "../../../../lib/useLatest";
import { useScheme } from "../../../../lib/useScheme";
import { LiveText } from "../../../../live/LiveText";
import { TURNS } from "../../../../live/turns";
import { useFrame } from "../../../../live/useFrame";
import { useTelemetries } from "../../../../live/useTelemetry";
import { ROWS_PER_PIXEL } from "../../../../live/window";
import { Plot } from "../../../../plots/Plot";
import { type PlotData, resampled } from "../../../../plots/series";
import type { Overlay, PlotHandle, PlotScale, PlotSeries } from "../../../../plots/types";
import { DASHES } from "../model";
import scopeClasses from "../scope.module.css";
import type { FreePlot, ScopeSettings } from "../settings";
import type { Scope } from "../useScope";
import { Feed } from "./feed";
import classes from "./free.module.css";
import { added, Channels, DRAGGED, derivedName, placeOf, refusal, requestsFor, unitsOf, without } from "./plan";
import { spectrumOf } from "./spectrum";
import { statisticsOf } from "./statistics";

const KINDS = [
  { value: "time", label: "time" },
  { value: "xy", label: "XY" },
  { value: "spectrum", label: "spectrum" },
] as const;
/** A spectrum takes as long as a hundred plots: so often is enough [ms]. */
const SPECTRUM_MS = 200;
/** So often the figures of a panel are worked out: people read them [ms]. */
const FIGURES_MS = 500;
const DOTS_MAX = 2000;

/** Whose time plots show: the scope's, or that of a panel of its own. */
export type PlotTime = Pick<
  Scope,
  "view" | "shiftOf" | "measured" | "marks" | "moveMark" | "changeWindow" | "hover" | "setHover"
>;

interface Props {
  scope: PlotTime;
  devices: readonly Device[];
  settings: Pick<ScopeSettings, "free" | "derived" | "rateHz">;
  change: (part: { free: FreePlot[] }) => void;
  /** what the one plot of a panel is called: it stays of its kind, and has a time axis of its own */
  alone?: string;
}

/** Plots that the user has put together: any channel of any device, on the scope's own time. */
export function FreePlots({ scope, change, ...rest }: Props) {
  const { view, measured, shiftOf, marks, moveMark, changeWindow, hover, setHover } = scope;
  const steps = useLatest({ shiftOf, moveMark, changeWindow, hover, setHover });
  // other marks are drawn at once, also while nothing moves
  const time = useMemo(() => ({ view, measured, marks, ...steps }), [view, measured, marks, steps]);
  return <Plots {...rest} scope={time} {...useLatest({ change })} />;
}

/** Made anew only where something of them changes: whoever has them tells several times a second how a link is. */
const Plots = memo(({ scope, devices, settings, change, alone }: Props) => {
  const scheme = useScheme();
  const { free } = settings;
  const channels = useMemo(() => new Channels(devices, settings.derived), [devices, settings.derived]);
  const requests = useMemo(() => requestsFor(free, channels, settings.rateHz), [free, channels, settings.rateHz]);
  const sources = useTelemetries(requests);
  const feed = useMemo(
    () => new Feed(channels, { sources, bufferOf: (source) => scope.view.bufferOf(source), shiftOf: scope.shiftOf }),
    [channels, sources, scope.view, scope.shiftOf],
  );
  const handles = useRef(new Map<string, PlotHandle>());
  const dots = useRef(new Map<string, Overlay[]>());
  const drawn = useRef(new Map<string, { state: string; revision: number; ms: number }>());
  const name = useId();
  const figured = useRef(new Map<string, { atMs: number; revision: number; text: string }>());

  // biome-ignore lint/correctness/useExhaustiveDependencies: what has to be drawn anew
  useEffect(() => drawn.current.clear(), [feed, free, scheme]);
  // what the cursors' table measures, of the scope's plots and of those in panels of their own
  const { measured } = scope;
  useEffect(() => {
    const all = free.flatMap(({ y }) => y);
    measured.set(
      name,
      all.map((path) => ({
        key: path,
        label: channels.label(path),
        unit: channels.unit(path) ?? "",
        samples: (window) => feed.samples(path, window),
      })),
    );
    return () => void measured.delete(name);
  }, [measured, name, free, channels, feed]);

  useFrame((nowMs) => {
    const window = scope.view.current();
    const revisions = sources.map((source) => scope.view.bufferOf(source).revision).join();
    for (const plot of free) {
      const handle = handles.current.get(plot.id);
      const width = handle?.uplot?.over.clientWidth ?? 0;
      const state = `${window.join()} ${revisions} ${width} ${scope.view.revision}`;
      const before = drawn.current.get(plot.id);
      if (!handle || width === 0 || before?.state === state) continue;
      const { revision } = scope.view;
      if (plot.kind === "spectrum" && before && nowMs - before.ms < SPECTRUM_MS) continue;
      // what a hand has changed does not wait for its turn
      if (!TURNS.take(`${name} ${plot.id}`, nowMs) && before?.revision === revision) continue;
      drawn.current.set(plot.id, { state, revision, ms: nowMs });
      if (plot.kind === "time") handle.setData(feed.overTime(plot.y, window, width * ROWS_PER_PIXEL), window);
      else if (plot.kind === "spectrum") drawSpectrum(handle, plot, window);
      else drawPairs(handle, plot, window);
    }
  });

  function drawSpectrum(handle: PlotHandle, { y }: FreePlot, window: readonly [number, number]) {
    const spectra = y.map((path) => spectrumOf(feed.samples(path, window)));
    const [first] = spectra.filter((each) => each !== null);
    const x = first?.frequencyHz ?? new Float64Array();
    const columns = spectra.map((each) =>
      each === null
        ? new Float64Array(x.length).fill(Number.NaN)
        : each === first
          ? each.amplitude
          : resampled(x, each.frequencyHz, each.amplitude, 0, Number.POSITIVE_INFINITY),
    );
    handle.setData([x, ...columns] as PlotData, [0, x.at(-1) ?? 1]);
  }

  function drawPairs(handle: PlotHandle, { id, y }: FreePlot, window: readonly [number, number]) {
    const [across = "", ...up] = y;
    const pairs = up.map((path) => feed.pairs(across, path, window, DOTS_MAX));
    let [low, high] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
    for (const { x } of pairs)
      for (const value of x) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
    const air = (high - low || 1) / 40;
    dots.current.set(
      id,
      pairs.map((pair, index) => ({ ...pair, dots: 2, color: colorFor(up[index] ?? "", scheme) })),
    );
    const edges: [number, number] = high >= low ? [low - air, high + air] : [0, 1];
    handle.setData([edges], edges);
  }

  const replace = (id: string, part: Partial<FreePlot>) =>
    change({ free: free.map((each) => (each.id === id ? { ...each, ...part } : each)) });

  return free.map((plot, index) => (
    <FreeRow
      key={plot.id}
      plot={plot}
      number={index + 1}
      alone={alone}
      figures={(path) => {
        const before = figured.current.get(path);
        const atMs = performance.now();
        const { revision } = scope.view;
        if (before?.revision === revision && atMs - before.atMs < FIGURES_MS) return before.text;
        const [from, to] = scope.view.current();
        const { minimum, maximum, rms } = statisticsOf(feed.samples(path, [from, to]), from, to);
        const values = `${compact(minimum, 3)} to ${compact(maximum, 3)}, RMS ${compact(rms, 3)}`;
        const text = Number.isNaN(rms) ? "no values in this time" : values;
        figured.current.set(path, { atMs, revision, text });
        return text;
      }}
      channels={channels}
      scheme={scheme}
      scope={scope}
      value={(path) => feed.value(path, scope.hover(), scope.view.current())}
      handle={(handle) => {
        if (handle) handles.current.set(plot.id, handle);
        else handles.current.delete(plot.id);
        drawn.current.delete(plot.id);
      }}
      overlays={() => dots.current.get(plot.id) ?? []}
      onDrop={(path) => {
        const next = added(free, plot.id, path, channels);
        if ("refused" in next) return next.refused;
        change(next);
        return null;
      }}
      onKind={(kind) => {
        const refused = refusedAs({ ...plot, kind }, channels);
        if (refused === null) replace(plot.id, { kind });
        return refused;
      }}
      onRemove={(path) => change({ free: without(free, plot.id, path) })}
      onClose={() => change({ free: free.filter((each) => each !== plot) })}
    />
  ));
});

/** Why a plot cannot be of another kind with the channels that it has. */
function refusedAs(plot: FreePlot, channels: Channels): string | null {
  const built: FreePlot = { ...plot, y: [] };
  for (const path of plot.y) {
    const refused = channels.unit(path) === null ? null : refusal(built, path, channels);
    if (refused !== null) return refused;
    built.y.push(path);
  }
  return null;
}

function colorFor(path: string, scheme: "light" | "dark"): string {
  return colorOf(placeOf(path)?.channel.replace(/\.\d+$/, "") ?? "derived", scheme);
}

function seriesOf({ y, kind }: FreePlot, channels: Channels, scheme: "light" | "dark"): PlotSeries[] {
  if (kind === "xy") return [];
  const units = unitsOf({ id: "", kind, y }, channels);
  const colors = new Map<string, number>();
  return y.map((path) => {
    const color = colorFor(path, scheme);
    const again = colors.get(color) ?? 0;
    colors.set(color, again + 1);
    const unit = channels.unit(path) ?? "";
    const dash = derivedName(path) === null ? DASHES[(again - 1) % DASHES.length] : lineOf("derived", scheme).dash;
    return {
      label: channels.label(path),
      color,
      unit,
      scale: units.indexOf(unit) > 0 ? "y2" : "y",
      ...((again > 0 || derivedName(path) !== null) && dash ? { dash } : {}),
    };
  });
}

interface RowProps {
  plot: FreePlot;
  number: number;
  channels: Channels;
  scheme: "light" | "dark";
  scope: PlotTime;
  alone: string | undefined;
  value: (path: string) => number;
  /** of the time that is shown */
  figures: (path: string) => string;
  handle: (handle: PlotHandle | null) => void;
  overlays: () => readonly Overlay[];
  /** what was dropped; the answer says why it is not taken */
  onDrop: (path: string) => string | null;
  onKind: (kind: FreePlot["kind"]) => string | null;
  onRemove: (path: string) => void;
  onClose: () => void;
}

function FreeRow(props: RowProps) {
  const { plot, number, channels, scheme, scope, alone } = props;
  const name = alone ?? `Plot ${number}`;
  const [said, setSaid] = useState<string | null>(null);
  const [over, setOver] = useState(false);
  const series = seriesOf(plot, channels, scheme);
  const units = unitsOf(plot, channels);
  const timed = plot.kind === "time";
  const scales: Record<string, PlotScale> = { y: { unit: units[0] ?? "" } };
  if (timed && units[1] !== undefined) scales.y2 = { unit: units[1], side: "right" };
  const across = plot.kind === "xy" ? (plot.y[0] ?? "") : "";
  const x: PlotScale =
    plot.kind === "time"
      ? { label: "time", unit: "s", axis: alone !== undefined }
      : plot.kind === "spectrum"
        ? { label: "frequency", unit: "Hz" }
        : { label: channels.label(across), unit: channels.unit(across) ?? "" };
  const names = plot.y.map((path) => channels.label(path)).join(", ");
  const takes = (event: DragEvent) => {
    if (!event.dataTransfer.types.includes(DRAGGED)) return;
    event.preventDefault();
    setOver(true);
  };
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: dragging is one way; the tree's checkboxes are the other
    <div
      className={`${scopeClasses.row} ${classes.plot} ${over ? classes.over : ""}`}
      data-testid={alone ? "panel-plot" : `free-plot-${number}`}
      onDragOver={takes}
      onDragEnter={takes}
      onDragLeave={() => setOver(false)}
      onDrop={(event) => {
        setOver(false);
        const path = event.dataTransfer.getData(DRAGGED);
        if (path === "") return;
        event.preventDefault();
        setSaid(props.onDrop(path));
      }}
    >
      <Plot
        label={`${name}: ${names}`}
        series={series}
        x={x}
        scales={scales}
        height="100%"
        {...(timed ? { group: "scope" } : {})}
        legend={false}
        handle={props.handle}
        overlays={props.overlays}
        {...(timed
          ? {
              marks: scope.marks(false),
              onMark: scope.moveMark,
              onWindow: scope.changeWindow,
              onCursor: (at) => scope.setHover(at?.x ?? null),
            }
          : {})}
      />
      <div className={scopeClasses.panel}>
        {alone === undefined && (
          <div className="flex between gap-6 mb-4 mid">
            <Text component="h3" size="xs" fw={600} className="nowrap">
              Plot {number}
            </Text>
            <Select
              w={92}
              size="xs"
              aria-label={`Kind of plot ${number}`}
              data={[...KINDS]}
              value={plot.kind}
              allowDeselect={false}
              onChange={(kind) => kind && setSaid(props.onKind(kind as FreePlot["kind"]))}
            />
            <ActionIcon size={24} variant="subtle" aria-label={`Close plot ${number}`} onClick={props.onClose}>
              <IconX size={14} />
            </ActionIcon>
          </div>
        )}
        <ul className="list">
          {plot.y.map((path, index) => (
            <li key={path} className="row gap-6 text-12 tight">
              <span
                className={scopeClasses.swatch}
                style={{
                  borderTop: `2px ${series[index]?.dash ? "dashed" : "solid"} ${colorFor(path, scheme)}`,
                }}
              />
              <span className="clip grow shrink" title={channels.label(path)}>
                {plot.kind === "xy" && index === 0 && "x: "}
                {channels.label(path)}
              </span>
              <LiveText
                className="num text-12 mono right nowrap"
                data-path={path}
                read={() => compact(props.value(path), 5)}
              />
              {channels.unit(path) === null && <span className="dim">gone</span>}
              <button
                type="button"
                className="plain"
                aria-label={`Take ${channels.label(path)} out of ${alone ?? `plot ${number}`}`}
                onClick={() => props.onRemove(path)}
              >
                <IconX size={12} aria-hidden />
              </button>
            </li>
          ))}
        </ul>
        {alone !== undefined &&
          timed &&
          plot.y.map((path) => (
            <LiveText key={path} className="num hint" data-figures={path} read={() => props.figures(path)} />
          ))}
        <Text size="xs" c="red" role="status">
          {said}
        </Text>
      </div>
    </div>
  );
}
