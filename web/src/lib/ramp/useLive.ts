import { useMemo, useRef, useState } from "react";
import type { PlotHandle } from "../../plots/types";
import type { Kind } from "./answer";
import type { LiveDrawing } from "./LiveMotion";
import type { LiveOverlays, PlotHandles } from "./RampView";

/** The plots of a page by quantity, and what the chip's motion draws over them. `kinds` does not change. */
export function useLive(kinds: readonly Kind[]) {
  // biome-ignore lint/correctness/useExhaustiveDependencies: a page has the plots that it has
  const plots = useMemo<PlotHandles>(
    () => Object.fromEntries(kinds.map((kind) => [kind, { current: null as PlotHandle | null }])),
    [],
  );
  const drawing: LiveDrawing = useRef({});
  const live = useMemo<LiveOverlays>(() => (kind) => drawing.current[kind] ?? [], []);
  const [seen, setSeen] = useState(false);
  return { plots, drawing, live, seen, setSeen };
}
