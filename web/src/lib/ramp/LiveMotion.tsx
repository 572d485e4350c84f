import { type RefObject, useEffect, useRef } from "react";
import type { Device } from "../../api/queries";
import { useFrame } from "../../live/useFrame";
import { useTelemetry } from "../../live/useTelemetry";
import { cut } from "../../live/window";
import type { Overlay } from "../../plots/types";
import { useScheme } from "../useScheme";
import type { Kind } from "./answer";
import { channelsOf, firstOf, mirrored, thinned } from "./overlay";
import type { PlotHandles } from "./RampView";

const RATE_HZ = 1000;
const KEEP_S = 60;
/** More would hide the ramp under them. */
const MOST_DOTS = 90;

/** What the chip does, for the plots to draw over the ramp: filled by `LiveMotion`, read when a plot draws. */
export type LiveDrawing = RefObject<Partial<Record<Kind, Overlay[]>>>;

interface Props {
  device: Device;
  axis: number;
  way: 1 | -1;
  /** how long the ramp's plots are [s] */
  endS: number;
  /** what is laid over its plot, velocity among it, and what one unit of that plot is [microsteps, pps, pps²] */
  factors: Partial<Record<Kind, number>>;
  plots: PlotHandles;
  drawing: LiveDrawing;
  /** there is a motion to see, measured from its start */
  onSeen: (seen: boolean) => void;
}

/** Lays each move of the axis over the ramp from the moment it began: measured as dots, as the driver expects it dashed. */
export function LiveMotion({ device, axis, way, endS, factors, plots, drawing, onSeen }: Props) {
  const scheme = useScheme();
  const kinds = Object.keys(factors) as Kind[];
  const channels = channelsOf(device, axis, kinds);
  const { buffer, source } = useTelemetry(device.id, channels, Math.min(RATE_HZ, device.rate_max_hz), KEEP_S);
  const began = useRef<number | null>(null);
  const drawn = useRef("");

  useEffect(
    () =>
      source.on("move", (move) => {
        if (move.axis !== axis) return;
        began.current = move.started_at_s;
        onSeen(true);
      }),
    [source, axis, onSeen],
  );
  useEffect(
    () => () => {
      drawing.current = {};
      onSeen(false);
    },
    [drawing, onSeen],
  );

  useFrame(() => {
    const start = began.current;
    if (start === null) return;
    const until = Math.min(buffer.lastTime, start + endS);
    const units = Object.values(factors).join();
    const key = `${start} ${until} ${endS} ${way} ${units} ${scheme} ${buffer.lastTime > start}`;
    if (key === drawn.current || !(until > start)) return;
    drawn.current = key;
    const ink = scheme === "light" ? "#111827" : "#f3f4f6";
    const warm = scheme === "light" ? "#a86400" : "#e69f00";
    const traces = kinds.flatMap((kind) =>
      [kind, `predicted_${kind}`].map((quantity) => ({ channel: `${quantity}.${axis}`, divisor: factors[kind] ?? 1 })),
    );
    const { x, columns } = cut(buffer, traces, start, until, 4000);
    const flip = mirrored(columns[2 * kinds.indexOf("velocity")] ?? [], way);
    const dots = thinned(x.length, MOST_DOTS);
    const some = (values: ArrayLike<number>) => dots.map((row) => values[row] ?? Number.NaN);
    kinds.forEach((kind, index) => {
      const measured = columns[2 * index] ?? new Float64Array(0);
      // a ramp begins at 0, wherever the motor stood
      const origin = kind === "position" ? firstOf(measured) : 0;
      const side = (values: Float64Array | undefined) =>
        (values ?? new Float64Array(0)).map((value) => (flip ? origin - value : value - origin));
      drawing.current[kind] = [
        { x, y: side(columns[2 * index + 1]), shift: -start, color: warm, dash: [5, 3], width: 1.5, aside: true },
        { x: some(x), y: some(side(measured)), shift: -start, color: ink, dots: 4, aside: true },
      ];
      plots[kind]?.current?.redraw();
    });
  });
  return null;
}
