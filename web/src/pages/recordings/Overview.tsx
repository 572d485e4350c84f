import { useEffect, useMemo, useRef } from "react";
import { useScheme } from "../../lib/useScheme";
import { Plot } from "../../plots/Plot";
import type { Mark, PlotHandle } from "../../plots/types";
import { type Band, usePlotBands } from "../../plots/usePlotBands";
import type { Lane } from "./channels";
import type { Piece, Window } from "./ZoomData";

interface Props {
  piece: Piece;
  lane: Lane | undefined;
  window: Window | null;
  onWindow: (window: Window | null) => void;
}

/** All of a recording in a strip, with the part that the plots below show; its ends can be dragged. */
export function Overview({ piece, lane, window, onWindow }: Props) {
  const scheme = useScheme();
  const handle = useRef<PlotHandle>(null);
  const first = piece.x[0] ?? 0;
  const last = piece.x.at(-1) ?? 1;
  const shade = scheme === "dark" ? "rgba(255, 255, 255, 0.09)" : "rgba(15, 23, 42, 0.08)";
  const bands: Band[] = window ? [{ from: window[0], to: window[1], color: shade }] : [];
  usePlotBands(handle, bands);
  const data = useMemo(
    () => [piece.x, ...(lane?.columns ?? []).map((column) => piece.columns[column] ?? [])] as const,
    [piece, lane],
  );
  useEffect(() => handle.current?.setData(data, [first, last]), [data, first, last]);
  const color = scheme === "dark" ? "#4d94e8" : "#1c6dd0";
  const marks: Mark[] = window
    ? [
        { id: "from", x: window[0], color },
        { id: "to", x: window[1], color },
      ]
    : [];
  if (lane === undefined) return null;
  return (
    <Plot
      label={`The whole recording: ${lane.title}`}
      series={lane.series}
      x={{ axis: false }}
      scales={{ y: { unit: lane.unit, ticks: (values) => values.map(() => "") } }}
      height={64}
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
  );
}
