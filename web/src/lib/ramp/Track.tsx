import { type RefObject, useEffect, useMemo, useRef } from "react";
import { Plot } from "../../plots/Plot";
import type { PlotData } from "../../plots/series";
import type { Mark, Overlay, PlotHandle, PlotScale, PlotSeries } from "../../plots/types";
import { type Band, usePlotBands } from "../../plots/usePlotBands";
import { CalmFrame, withHandles } from "./CalmFrame";
import { HandleLayer, type Reach } from "./HandleLayer";
import type { Handle } from "./handles";
import { engineering } from "./scales";

interface Props<P extends string> {
  /** plots of one group zoom together */
  group: string;
  label: string;
  summary: string;
  series: readonly PlotSeries[];
  data: PlotData;
  /** until when there is something to see [s] */
  window: readonly [number, number];
  bands: readonly Band[];
  height: number;
  /** braking is as large as accelerating: 0 stays in the middle */
  symmetric: boolean;
  overlays: readonly Overlay[] | (() => readonly Overlay[]);
  handle: RefObject<PlotHandle | null>;
  last?: boolean;
  right?: PlotScale;
  marks?: () => readonly Mark[];
  handles: readonly Handle<P>[];
  factor: number;
  reach: (parameter: P) => Reach;
  text: (parameter: P, value: number) => string;
  onChange: (parameter: P, value: number) => void;
  held: boolean;
  onHold: (held: boolean) => void;
}

/** One quantity of the ramp over time, with its handles. */
export function Track<P extends string>(props: Props<P>) {
  const { label, series, data, window, bands, handle, right, held, factor, symmetric } = props;
  // biome-ignore lint/correctness/useExhaustiveDependencies: another unit is another plot, whose range starts anew
  const frame = useMemo(() => new CalmFrame(symmetric), [symmetric, factor]);
  frame.held = held;
  const heights = useRef<readonly number[]>([]);
  heights.current = props.handles.map((each) => (each.sign * each.value) / factor);
  const scales = useMemo(
    () => ({
      y: {
        range: (min: number, max: number): [number, number] => frame.next(...withHandles(min, max, heights.current)),
        ticks: engineering,
      },
      ...(right ? { right } : {}),
    }),
    [frame, right],
  );
  const [from, to] = window;
  // After Plot's own effects: a rebuilt plot has to be there. A handle that is let go lets the range shrink.
  // biome-ignore lint/correctness/useExhaustiveDependencies: see above
  useEffect(() => handle.current?.setData(data, [from, to]), [data, from, to, handle, held, scales]);
  usePlotBands(handle, bands);
  return (
    <div className="relative">
      <Plot
        handle={handle}
        label={`${label} over time`}
        summary={props.summary}
        series={series}
        height={props.height}
        group={props.group}
        legend
        limit={window}
        overlays={props.overlays}
        {...(props.marks ? { marks: props.marks } : {})}
        x={props.last ? { label: "time", unit: "s" } : { axis: false }}
        scales={scales}
      />
      <HandleLayer
        plot={handle}
        handles={props.handles}
        factor={factor}
        color={series[0]?.color ?? "currentColor"}
        reach={props.reach}
        text={props.text}
        onChange={props.onChange}
        onHold={props.onHold}
      />
    </div>
  );
}
