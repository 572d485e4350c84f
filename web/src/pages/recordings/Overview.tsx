import { type Ref, useEffect, useImperativeHandle, useMemo, useRef, useState } from "react";
import { useScheme } from "../../lib/useScheme";
import { Plot } from "../../plots/Plot";
import type { Mark, PlotHandle } from "../../plots/types";
import type { Lane } from "./channels";
import classes from "./recordings.module.css";
import type { Piece, Window } from "./ZoomData";

export interface OverviewHandle {
  /** The plots show this part now; null: all. */
  show: (window: Window | null) => void;
}

interface Props {
  piece: Piece;
  lane: Lane | undefined;
  /** that of the plots below */
  stack: string;
  handle: Ref<OverviewHandle>;
  onWindow: (window: Window | null) => void;
}

/** All of a recording in a strip, with the part that the plots below show; its ends can be dragged. */
export function Overview({ piece, lane, stack, handle: outer, onWindow }: Props) {
  const scheme = useScheme();
  const handle = useRef<PlotHandle>(null);
  const first = piece.x[0] ?? 0;
  const last = piece.x.at(-1) ?? 1;
  const part = useRef<HTMLDivElement>(null);
  const [window, setWindow] = useState<Window | null>(null);
  const settling = useRef(0);
  // A shade over the strip that moves with every frame: the strip itself is not drawn again.
  const place = (next: Window | null) => {
    const plot = handle.current?.uplot;
    const { current } = part;
    if (!current || !plot) return;
    current.hidden = next === null;
    if (next === null) return;
    const left = plot.over.offsetLeft + plot.valToPos(Math.max(first, next[0]), "x");
    const right = plot.over.offsetLeft + plot.valToPos(Math.min(last, next[1]), "x");
    current.style.transform = `translateX(${left}px)`;
    current.style.width = `${Math.max(2, right - left)}px`;
  };
  useImperativeHandle(outer, () => ({
    show(next) {
      place(next);
      // the ends that can be dragged come when it stands still
      clearTimeout(settling.current);
      settling.current = globalThis.setTimeout(() => setWindow(next), 200) as unknown as number;
    },
  }));
  useEffect(() => () => clearTimeout(settling.current), []);
  const data = useMemo(
    () => [piece.x, ...(lane?.columns ?? []).map((column) => piece.columns[column] ?? [])] as const,
    [piece, lane],
  );
  useEffect(() => handle.current?.setData(data, [first, last]), [data, first, last]);
  const color = scheme === "dark" ? "#4d94e8" : "#1c6dd0";
  const marks = useMemo<Mark[]>(
    () =>
      window
        ? [
            { id: "from", x: window[0], color },
            { id: "to", x: window[1], color },
          ]
        : [],
    [window, color],
  );
  if (lane === undefined) return null;
  return (
    <div className="shrink relative">
      <Plot
        label={`The whole recording: ${lane.title}`}
        series={lane.series}
        x={{ axis: false }}
        scales={{ y: { unit: lane.unit, ticks: (values) => values.map(() => "") } }}
        height={64}
        stack={stack}
        legend={false}
        limit={[first, last]}
        handle={handle}
        marks={marks}
        onMark={(id, x) => {
          if (window === null) return;
          const [from, to] = id === "from" ? [x, window[1]] : [window[0], x];
          onWindow(from < to ? [from, to] : [to, from]);
        }}
        // what is dragged over here is what the plots below show; a wheel over it zooms them
        onWindow={(change) => {
          onWindow(change === "reset" ? null : [Math.max(first, change.min), Math.min(last, change.max)]);
          return true;
        }}
      />
      <div ref={part} className={classes.part} hidden />
    </div>
  );
}
