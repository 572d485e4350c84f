import { type CSSProperties, type Ref, useEffect, useId, useImperativeHandle, useRef } from "react";
import uPlot from "uplot";
import { inter } from "../font";
import { compact } from "../lib/format";
import { symbolOf } from "../lib/units";
import { useScheme } from "../lib/useScheme";
import { drawingPlugin } from "./drawing";
import { guttersOf } from "./gutters";
import { handleKey, type InteractionHost, pointerPlugin } from "./interaction";
import { type Build, buildOptions } from "./options";
import classes from "./Plot.module.css";
import type { Subject } from "./picture";
import { SaveButton } from "./SaveButton";
import { aligned, type PlotData } from "./series";
import type { Level, Mark, Overlay, PlotHandle, PlotScale, PlotSeries, WindowChange } from "./types";

export interface PlotProps {
  /** what the plot shows, for people who do not see it; its values at the cursor are read out with the keys */
  label: string;
  /** what all its series are, before their names in the legend */
  title?: string;
  /** one sentence on what there is to see now: "Settles after 0.42 s, 1 step overshoot" */
  summary?: string;
  series: readonly PlotSeries[];
  /** x, then one column a series. For live data leave it out and call `handle.setData` from outside of rendering. */
  data?: PlotData;
  handle?: Ref<PlotHandle>;
  x?: PlotScale;
  /** by key; "y" is the one of series that name none */
  scales?: Readonly<Record<string, PlotScale>>;
  height?: CSSProperties["height"];
  /** plots of one group share cursor and x window */
  group?: string;
  /** plots of one stack have their left and right ends on one vertical line; by default those of the group */
  stack?: string;
  /** it says nothing that the plots beside it do not: an axis of theirs. Neither read out nor reached by keys */
  scenery?: boolean;
  /** names, colours and values at the cursor, above the plot; by default where there is more than one series */
  legend?: boolean;
  overlays?: readonly Overlay[] | (() => readonly Overlay[]);
  marks?: readonly Mark[] | (() => readonly Mark[]);
  onMark?: (id: string, x: number) => void;
  levels?: readonly Level[] | (() => readonly Level[]);
  onLevel?: (id: string, y: number) => void;
  /** told of every zoom and pan; returning true says that the parent sets the window itself */
  onWindow?: (change: WindowChange) => boolean | undefined;
  /** the x under the cursor and its row; null where the cursor is off the plot */
  onCursor?: (at: { x: number; row: number } | null) => void;
  /** keys before the plot's own; true: handled */
  onKey?: (key: string, at: number | null) => boolean;
  /** bounds that zooming never leaves; by default none, so that a live window can look ahead */
  limit?: readonly [number, number];
}

/** uPlot instances of a group: their x windows move together. uPlot itself only shares the cursor. */
const groups = new Map<string, Set<uPlot>>();

const EMPTY: PlotScale = {};
const NO_SCALES: Readonly<Record<string, PlotScale>> = {};

function list<T>(items: readonly T[] | (() => readonly T[]) | undefined): readonly T[] {
  return typeof items === "function" ? items() : (items ?? []);
}

/**
 * A chart: a thin wrapper around uPlot. Data go in outside of React's rendering; wheel, drag, touch and keys zoom and
 * pan; it follows its box and the colour scheme.
 */
export function Plot(props: PlotProps) {
  const { label, summary, series, data, handle, x = EMPTY, scales = NO_SCALES, height = 220, group } = props;
  const stack = props.stack ?? group;
  const legend = props.legend ?? series.length > 1;
  const scheme = useScheme();
  const help = useId();
  const frame = useRef<HTMLDivElement>(null);
  const host = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const subject = useRef<(() => Subject) | null>(null);
  const held = useRef<PlotData | null>(null);
  const values = useRef<(HTMLSpanElement | null)[]>([]);
  const spoken = useRef<HTMLDivElement>(null);
  const latest = useRef(props);
  latest.current = props;

  // What the instance is built from, by content: parents may write their series in line without rebuilding the plot.
  const shape = JSON.stringify(
    [scheme, series, x, scales, group, stack, props.onWindow !== undefined],
    (_key, value: unknown) => (typeof value === "function" ? "function" : value),
  );

  const interaction = useRef<InteractionHost>({
    bounds: () => {
      const times = held.current?.[0];
      return times && times.length > 0 ? [times[0] as number, times[times.length - 1] as number] : [0, 1];
    },
    limit: () => latest.current.limit ?? null,
    changeWindow: (change) => {
      if (latest.current.onWindow?.(change) === true) return;
      const [min, max] = change === "reset" ? interaction.current.bounds() : [change.min, change.max];
      const key = latest.current.group;
      const members = key === undefined ? undefined : groups.get(key);
      for (const member of members ?? (plot.current ? [plot.current] : [])) member.setScale("x", { min, max });
    },
    marks: () => list(latest.current.marks),
    moveMark: (id, at) => latest.current.onMark?.(id, at),
    levels: () => list(latest.current.levels),
    moveLevel: (id, at) => latest.current.onLevel?.(id, at),
  });

  useImperativeHandle(
    handle,
    (): PlotHandle => ({
      setData(next, window) {
        held.current = aligned(next);
        const current = plot.current;
        // Series have come or gone and the instance has not been rebuilt yet: it will start with what is held.
        if (!current || current.series.length !== next.length) return;
        const first = current.data[0]?.length === 0;
        current.setData(held.current as unknown as uPlot.AlignedData, !window && first);
        if (window) current.setScale("x", { min: window[0], max: window[1] });
        else if (!first) {
          const { min, max } = current.scales.x ?? {};
          if (min != null && max != null) current.setScale("x", { min, max });
        }
      },
      setWindow: (min, max) => plot.current?.setScale("x", { min, max }),
      reset: () => interaction.current.changeWindow("reset"),
      redraw: () => plot.current?.redraw(false, false),
      get uplot() {
        return plot.current;
      },
    }),
    [],
  );

  // biome-ignore lint/correctness/useExhaustiveDependencies: `shape` is everything that the instance is built from
  useEffect(() => {
    const box = host.current;
    if (!box) return;
    const old = plot.current?.scales.x;
    const gutters = guttersOf(stack);
    const showValues = (current: uPlot) => {
      const row = current.cursor.idx;
      const off = row === null || row === undefined || (current.cursor.left ?? -1) < 0;
      latest.current.series.forEach((entry, index) => {
        const cell = values.current[index];
        if (!cell) return;
        const value = off ? null : current.data[index + 1]?.[row];
        cell.textContent = off ? "" : compact(value as number | null, 5);
        cell.title = entry.unit ?? "";
      });
      latest.current.onCursor?.(off ? null : { x: current.posToVal(current.cursor.left ?? 0, "x"), row });
    };
    const overlays = () => list(latest.current.overlays);
    const drawing = drawingPlugin(
      overlays,
      () => list(latest.current.marks),
      () => list(latest.current.levels),
    );
    const build: Build = {
      size: { width: Math.max(80, box.clientWidth), height: Math.max(40, box.clientHeight) },
      scheme,
      series: latest.current.series,
      x: latest.current.x ?? EMPTY,
      scales: latest.current.scales ?? NO_SCALES,
      syncKey: group,
      gutters,
      overlays,
      selects: true,
      plugins: [drawing, pointerPlugin(interaction.current)],
    };
    const instance = new uPlot(
      {
        ...buildOptions(build),
        hooks: {
          setCursor: [showValues],
          setData: [showValues],
          setSize: [(current) => frame.current?.style.setProperty("--plot-left", `${current.over.offsetLeft}px`)],
          setSelect: [
            (current) => {
              const { left, width } = current.select;
              if (width < 3) return;
              const change = { min: current.posToVal(left, "x"), max: current.posToVal(left + width, "x") };
              current.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
              interaction.current.changeWindow(change);
            },
          ],
        },
      },
      (held.current?.length === latest.current.series.length + 1
        ? held.current
        : [[], ...latest.current.series.map(() => [])]) as unknown as uPlot.AlignedData,
      box,
    );
    plot.current = instance;
    subject.current = () => ({
      title: [latest.current.title, latest.current.label].filter(Boolean).join(": "),
      plot: instance,
      build: {
        ...build,
        size: { width: instance.width, height: instance.height },
        syncKey: undefined,
        gutters: guttersOf(undefined),
        selects: false,
        plugins: [drawing],
      },
    });
    if (old?.min != null && old.max != null) instance.setScale("x", { min: old.min, max: old.max });
    if (group !== undefined) {
      const members = groups.get(group) ?? new Set();
      groups.set(group, members.add(instance));
    }
    const observer = new ResizeObserver(() => {
      if (box.clientWidth > 0 && box.clientHeight > 0)
        instance.setSize({ width: box.clientWidth, height: box.clientHeight });
    });
    observer.observe(box);
    let there = true;
    void inter().then(() => {
      if (there) instance.redraw(false, true);
    });
    return () => {
      there = false;
      observer.disconnect();
      if (group !== undefined) groups.get(group)?.delete(instance);
      gutters.leave(instance);
      instance.destroy();
    };
  }, [shape]);

  useEffect(() => {
    if (!data) return;
    held.current = aligned(data);
    if (plot.current?.series.length !== data.length) return;
    plot.current.setData(held.current as unknown as uPlot.AlignedData, true);
  }, [data]);

  const { overlays, marks, levels } = props;
  // biome-ignore lint/correctness/useExhaustiveDependencies: the instance reads them from `latest` when it draws
  useEffect(() => {
    // with the scales: overlays count for the y range
    plot.current?.redraw(false, true);
    const { min, max } = plot.current?.scales.x ?? {};
    if (min != null && max != null) plot.current?.setScale("x", { min, max });
  }, [overlays, marks, levels]);

  function speak() {
    const current = plot.current;
    const row = current?.cursor.idx;
    if (!current || row === null || row === undefined || !spoken.current) return;
    const at = `${x.label ?? "x"} ${compact(current.data[0][row])} ${symbolOf(x.unit ?? "")}`;
    const each = series.map((entry, index) => {
      const value = current.data[index + 1]?.[row] as number | null;
      return `${entry.label} ${compact(value)} ${symbolOf(entry.unit ?? "")}`;
    });
    spoken.current.textContent = [at, ...each].join(", ");
  }

  return (
    <div ref={frame} className={`${classes.frame} stack shrink relative`} style={{ height }}>
      {legend && (
        <div className={`${classes.legend} lines-12 hint`} aria-hidden>
          {props.title && <span className="ink bold">{props.title}</span>}
          {series.map((entry, index) =>
            entry.unnamed ? null : (
              <span key={entry.label} className="inline gap-4 nowrap">
                <span className="swatch" style={{ background: entry.color }} />
                {entry.label}
                {entry.unit ? ` ${symbolOf(entry.unit)}` : ""}
                <span
                  className={classes.value}
                  ref={(cell) => {
                    values.current[index] = cell;
                  }}
                />
              </span>
            ),
          )}
        </div>
      )}
      <div
        ref={host}
        className={classes.canvas}
        role="img"
        aria-hidden={props.scenery}
        aria-label={summary ? `${label}. ${summary}` : label}
        aria-describedby={help}
        // the arrow keys move its cursor, + and - zoom
        tabIndex={props.scenery ? undefined : 0}
        onKeyDown={(event) => {
          const current = plot.current;
          if (!current || event.ctrlKey || event.metaKey || event.altKey) return;
          const left = current.cursor.left ?? -1;
          const at = left >= 0 ? current.posToVal(left, "x") : null;
          const own = props.onKey?.(event.key, at) ?? false;
          if (own || handleKey(current, event.key, event.shiftKey, interaction.current)) {
            event.preventDefault();
            event.stopPropagation();
            speak();
          }
        }}
      />
      {!props.scenery && <SaveButton name={label} subject={() => subject.current?.() ?? null} />}
      <span id={help} className="unseen nowrap">
        Arrow keys move the cursor, plus and minus zoom, Page up and Page down pan, 0 shows all.
      </span>
      <div ref={spoken} className="unseen nowrap" aria-live="polite" />
    </div>
  );
}
