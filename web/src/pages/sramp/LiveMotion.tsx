import { type RefObject, useEffect, useRef } from "react";
import type { Device } from "../../api/queries";
import { useScheme } from "../../lib/useScheme";
import { useFrame } from "../../live/useFrame";
import { useTelemetry } from "../../live/useTelemetry";
import { cut } from "../../live/window";
import type { Overlay } from "../../plots/types";
import type { Kind } from "./design";
import { channelsOf, mirrored, thinned } from "./overlay";
import type { PlotHandles } from "./SRampPlots";

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
  factors: Record<"velocity" | "acceleration", number>;
  plots: PlotHandles;
  drawing: LiveDrawing;
  /** there is a motion to see, measured from its start */
  onSeen: (seen: boolean) => void;
}

/** Lays each move of the axis over the ramp from the moment it began: measured as dots, as the driver expects it dashed. */
export function LiveMotion({ device, axis, way, endS, factors, plots, drawing, onSeen }: Props) {
  const scheme = useScheme();
  const channels = channelsOf(device, axis);
  const { buffer, source } = useTelemetry(device.id, channels, Math.min(RATE_HZ, device.rate_max_hz), KEEP_S);
  const began = useRef<number | null>(null);
  const drawn = useRef("");

  useEffect(
    () =>
      source.onMove((move) => {
        if (move.axis !== axis) return;
        began.current = move.startedAtS;
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
    const key = `${start} ${until} ${endS} ${way} ${factors.velocity} ${scheme} ${buffer.lastTime > start}`;
    if (key === drawn.current || !(until > start)) return;
    drawn.current = key;
    const ink = scheme === "light" ? "#111827" : "#f3f4f6";
    const warm = scheme === "light" ? "#b87400" : "#e69f00";
    const kinds = ["velocity", "acceleration"] as const;
    const names = kinds.flatMap((kind) => [`${kind}.${axis}`, `predicted_${kind}.${axis}`]);
    const { x, columns } = cut(
      buffer,
      names.map((channel, index) => ({ channel, divisor: index < 2 ? factors.velocity : factors.acceleration })),
      start,
      until,
      4000,
    );
    const flip = mirrored(columns[0] ?? [], way);
    const side = (values: Float64Array | undefined) =>
      flip && values ? values.map((value) => -value) : (values ?? []);
    const dots = thinned(x.length, MOST_DOTS);
    const some = (values: ArrayLike<number>) => dots.map((row) => values[row] ?? Number.NaN);
    kinds.forEach((kind, index) => {
      drawing.current[kind] = [
        { x, y: side(columns[2 * index + 1]), shift: -start, color: warm, dash: [5, 3], width: 1.5, aside: true },
        { x: some(x), y: some(side(columns[2 * index])), shift: -start, color: ink, dots: 4, aside: true },
      ];
      plots[kind].current?.redraw();
    });
  });
  return null;
}
