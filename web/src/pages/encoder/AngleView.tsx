import { Button, Group, SegmentedControl, Text } from "@mantine/core";
import { useRef, useState } from "react";
import { Card } from "../../lib/Card";
import { optionsOf } from "../../lib/choices";
import { fixed } from "../../lib/format";
import { LiveText } from "../../live/LiveText";
import { Plot } from "../../plots/Plot";
import type { PlotHandle, PlotSeries } from "../../plots/types";
import type { Direction } from "./angleMap";
import type { BinStats } from "./bins";
import classes from "./encoder.module.css";
import { type Curve, Polar } from "./Polar";
import { useMapChanges } from "./useEncoder";

type View = "polar" | "turn" | "steps";

/** From this much of a turn on [deg], a point is the mean of a full step; closer it is an eighth of one. */
const FINE_BELOW_DEG = 45;

interface Props {
  curves: readonly Curve[];
  direction: Direction;
  onDirection: (direction: Direction) => void;
  shaft: () => number;
  moving: boolean;
  onClear: () => void;
}

/** Deviation against the angle of the shaft, gathered over turns. */
export function AngleView({ curves, direction, onDirection, shaft, moving, onClear }: Props) {
  const [view, setView] = useState<View>("polar");
  const first = curves[0];
  const seen = () => {
    if (!first) return "";
    const { map } = first;
    const share = Math.round(100 * map.turn(direction, map.fullStepsPerTurn).covered);
    return `${fixed(map.histogram(direction).count)} samples, ${fixed(map.turns, 1)} turns, ${share} % of the turn seen`;
  };
  return (
    <Card
      title="Deviation against shaft angle"
      className="stack"
      actions={
        <>
          <SegmentedControl
            aria-label="Direction"
            data={optionsOf({ both: "Both ways", forward: "Forward", backward: "Back" })}
            value={direction}
            onChange={(value) => onDirection(value as Direction)}
          />
          <SegmentedControl
            aria-label="View"
            data={optionsOf({ polar: "Polar", turn: "Unrolled", steps: "Full steps" })}
            value={view}
            onChange={(value) => setView(value as View)}
          />
          <Button size="compact-xs" variant="default" onClick={onClear} data-testid="clear-map">
            Clear
          </Button>
        </>
      }
    >
      <div className={`${classes.angleBox} grow mb-4 relative`} data-testid="angle-view" data-view={view}>
        {view === "polar" && (
          <Polar
            curves={curves}
            direction={direction}
            shaft={shaft}
            summary="Mean deviation around the shaft with its spread; the middle ring is no deviation"
          />
        )}
        {view !== "polar" && <Unrolled key={view} curves={curves} direction={direction} view={view} />}
        {!moving && first && <EmptyHint curve={first} />}
      </div>
      <Group justify="space-between" gap="xs">
        <Text size="xs" c="dimmed">
          <LiveText className="num" read={seen} data-testid="angle-seen" />
        </Text>
        <Text size="xs" c="dimmed">
          {view === "steps"
            ? "All electrical periods of the turn laid over each other"
            : view === "turn"
              ? "Mean and spread of each full step; zoom in for eighths"
              : "Mean and spread of each full step; outside is ahead"}
        </Text>
      </Group>
    </Card>
  );
}

function EmptyHint({ curve }: { curve: Curve }) {
  return (
    <LiveText
      className={classes.emptyHint}
      read={() => (curve.map.histogram("both").count === 0 ? "Turn the motor: a slow turn fills this view." : "")}
    />
  );
}

/** x in degrees or full steps, then mean, mean + spread, mean - spread; empty bins are gaps. */
function columnsOf(bins: BinStats, period: number): [x: Float64Array, ...columns: Float64Array[]] {
  const x = Float64Array.from({ length: bins.size }, (_, bin) => ((bin + 0.5) * period) / bins.size);
  const pick = (value: (bin: number) => number) =>
    x.map((_, bin) => ((bins.count[bin] as number) === 0 ? Number.NaN : value(bin)));
  return [
    x,
    pick((bin) => bins.mean[bin] as number),
    pick((bin) => (bins.mean[bin] as number) + bins.spread(bin)),
    pick((bin) => (bins.mean[bin] as number) - bins.spread(bin)),
  ];
}

function Unrolled({ curves, direction, view }: Pick<Props, "curves" | "direction"> & { view: "turn" | "steps" }) {
  const plot = useRef<PlotHandle | null>(null);
  const [fine, setFine] = useState(false);
  const period = view === "turn" ? 360 : 4;
  useMapChanges(
    curves.map((curve) => curve.map),
    `${direction} ${fine} ${curves.map((curve) => curve.label).join()}`,
    () => {
      const tables = curves.map(({ map }) =>
        view === "steps" ? map.period(direction) : map.turn(direction, fine ? undefined : map.fullStepsPerTurn),
      );
      const [x] = columnsOf(tables[0] as BinStats, period);
      const columns = tables.flatMap((bins) => columnsOf(bins, period).slice(1) as Float64Array[]);
      const shown = plot.current?.uplot?.scales.x;
      const kept: [number, number] = shown?.min != null && shown.max != null ? [shown.min, shown.max] : [0, period];
      plot.current?.setData([x, ...columns], kept[1] > kept[0] ? kept : [0, period]);
    },
  );
  const series = curves.flatMap(({ color, label }): PlotSeries[] => [
    { label: curves.length > 1 ? label : "mean and spread", color, unit: "microsteps" },
    { label: `${label} + spread`, color: `${color}80`, unit: "microsteps", unnamed: true },
    { label: `${label} − spread`, color: `${color}80`, unit: "microsteps", unnamed: true },
  ]);
  return (
    <Plot
      label={view === "turn" ? "Deviation over one turn" : "Deviation over four full steps"}
      series={series}
      x={view === "turn" ? { label: "shaft angle", unit: "deg" } : { label: "full steps of an electrical period" }}
      scales={{ y: { unit: "microsteps", include: [0] } }}
      height="100%"
      limit={[0, period]}
      handle={(handle) => {
        plot.current = handle;
      }}
      onWindow={(change) => {
        const [min, max] = change === "reset" ? [0, period] : [change.min, change.max];
        plot.current?.setWindow(min, max);
        if (view === "turn") setFine(max - min < FINE_BELOW_DEG);
        return true;
      }}
    />
  );
}
