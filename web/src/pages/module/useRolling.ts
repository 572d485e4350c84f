import { useCallback, useEffect, useRef, useState } from "react";
import type { TelemetrySource } from "../../live/TelemetrySource";
import { useFrame } from "../../live/useFrame";
import { cut, ROWS_PER_PIXEL, type Trace } from "../../live/window";
import type { PlotHandle, WindowChange } from "../../plots/types";
import { ScopeView } from "../bench/scope/ScopeView";

interface Slot {
  handle: PlotHandle | null;
  traces: readonly Trace[];
  drawn: string;
}

/**
 * Plots that follow the newest samples of one source, all in one window of time, drawn in every frame outside of
 * React's rendering. Zooming and panning by hand holds the picture; "show all" goes on.
 */
export function useRolling(source: TelemetrySource, firstSpanS: number) {
  const [spanS, setSpanS] = useState(firstSpanS);
  const [view] = useState(() => new ScopeView(spanS, "roll"));
  const [paused, setPaused] = useState(false);
  const slots = useRef(new Map<string, Slot>());

  const run = useCallback(() => {
    view.run();
    setPaused(false);
  }, [view]);
  const pause = useCallback(
    (window?: readonly [number, number]) => {
      view.pause([source], window);
      setPaused(true);
    },
    [view, source],
  );
  useEffect(() => view.set(spanS, "roll"), [view, spanS]);
  // biome-ignore lint/correctness/useExhaustiveDependencies: another source is another time, and what is held is not of it
  useEffect(run, [run, source]);

  useFrame((nowMs) => {
    const buffer = view.bufferOf(source);
    const { window } = view.next(source.buffer.lastTime, nowMs);
    for (const slot of slots.current.values()) {
      const width = slot.handle?.uplot?.over.clientWidth ?? 0;
      if (slot.handle === null || width === 0) continue;
      const state = `${window.join()} ${buffer.revision} ${view.revision} ${width}`;
      if (slot.drawn === state) continue;
      slot.drawn = state;
      const { x, columns } = cut(buffer, slot.traces, window[0], window[1], width * ROWS_PER_PIXEL);
      slot.handle.setData([x, ...columns], window);
    }
  });

  return {
    view,
    spanS,
    setSpanS,
    paused,
    run,
    pause,
    /** what a plot's `handle` is to be; the traces in the order of its series */
    plot: (id: string, traces: readonly Trace[]) => (handle: PlotHandle | null) => {
      if (handle === null) slots.current.delete(id);
      else slots.current.set(id, { handle, traces, drawn: "" });
    },
    changeWindow: (change: WindowChange): boolean => {
      if (change === "reset") run();
      else pause([change.min, change.max]);
      return true;
    },
  };
}

export type Rolling = ReturnType<typeof useRolling>;
