import { useRef } from "react";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { LiveText } from "../../live/LiveText";
import { Plot } from "../../plots/Plot";
import type { PlotHandle, PlotSeries } from "../../plots/types";
import type { Direction } from "./angleMap";
import classes from "./encoder.module.css";
import type { Histogram } from "./histogram";
import type { Curve } from "./Polar";
import { useMapChanges } from "./useEncoder";

/** Bars as a line of steps: the left edge of each bar, and one last point that closes the last bar. */
export function stepsOf(histograms: readonly Histogram[]): [x: number[], ...columns: (number | null)[][]] {
  const all = histograms.map((histogram) => histogram.bars());
  const edges = [...new Set(all.flatMap((bars) => bars.flatMap((bar) => [bar.from, bar.to])))].sort((a, b) => a - b);
  const columns = all.map((bars) => {
    const byEdge = new Map(bars.map((bar) => [bar.from, bar.count]));
    let last: number | null = null;
    const end = bars.at(-1)?.to ?? Number.NEGATIVE_INFINITY;
    return edges.map((edge) => {
      if (edge >= end) last = edge === end ? 0 : null;
      else last = byEdge.get(edge) ?? last;
      return last;
    });
  });
  return [edges, ...columns];
}

/** How often each deviation came, with mean, rms and peak. */
export function HistogramView({ curves, direction }: { curves: readonly Curve[]; direction: Direction }) {
  const plot = useRef<PlotHandle | null>(null);
  const shown = useRef<readonly Histogram[]>([]);
  useMapChanges(
    curves.map((curve) => curve.map),
    `${direction} ${curves.map((curve) => curve.label).join()}`,
    () => {
      shown.current = curves.map((curve) => curve.map.histogram(direction));
      const data = stepsOf(shown.current);
      const [x] = data;
      const [from = -1, to = 1] = [x[0], x.at(-1)];
      const air = Math.max(1, (to - from) * 0.03);
      // one bar more on either side stays in view, so that the axis does not tremble
      plot.current?.setData(data, [from - air, to + air]);
    },
  );
  const series = curves.map(
    ({ color, label }): PlotSeries => ({ label, color, stepped: true, fill: `${color}40`, fillTo: 0 }),
  );
  return (
    <Card title="Distribution" note="samples in motion">
      <div className="mb-4">
        {curves.map(({ color, label }, index) => {
          const figure = (read: (histogram: Histogram) => number) => () => {
            const histogram = shown.current[index];
            return histogram === undefined || histogram.count === 0 ? "–" : fixed(read(histogram), 1);
          };
          return (
            <div key={label} className="mid lines-12 hint">
              {curves.length > 1 && <span className="swatch" style={{ background: color }} title={label} />}
              <Figure name="mean" read={figure((histogram) => histogram.mean)} />
              <Figure name="rms" read={figure((histogram) => histogram.rms)} />
              <Figure name="peak" read={figure((histogram) => histogram.peak)} />
            </div>
          );
        })}
      </div>
      <Plot
        label="How often each deviation came"
        series={series}
        legend={false}
        x={{ label: "deviation", unit: "microsteps" }}
        scales={{ y: { include: [0] } }}
        height={150}
        handle={(handle) => {
          plot.current = handle;
        }}
      />
    </Card>
  );
}

function Figure({ name, read }: { name: string; read: () => string }) {
  return (
    <span className="nowrap">
      {name}{" "}
      <LiveText
        className={`${classes.figureValue} inline-block ink bold mono right`}
        read={read}
        data-testid={`figure-${name}`}
      />{" "}
      µsteps
    </span>
  );
}
