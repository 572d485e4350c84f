import { Button } from "@mantine/core";
import { useMemo, useState } from "react";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { roundRange } from "../../../plots/ranges";
import type { PlotData } from "../../../plots/series";
import type { Level, Overlay, PlotSeries } from "../../../plots/types";
import { columnOf, farOnes, originOf, type Run, reachOf, type View, wayOf } from "./runs";

/** Curves of before, from the newer to the older: paler, and told apart by their dashes. */
const GHOSTS: readonly { light: string; dark: string; dash: number[] }[] = [
  { light: "#a86400", dark: "#e69f00", dash: [7, 3] },
  { light: "#5c5200", dark: "#f0e442", dash: [3, 3] },
  { light: "#6b7480", dark: "#9aa3ad", dash: [10, 4, 2, 4] },
  { light: "#8a93a0", dark: "#7a828c", dash: [2, 4] },
  { light: "#a3abb5", dark: "#69717b", dash: [1, 3] },
];
const PLAIN = { light: "#6b7480", dark: "#7a828c" };
const UNITS: Record<View, string> = { position: "microsteps", deviation: "microsteps", velocity: "pps", angle: "deg" };
const NAMES: Record<View, string> = {
  position: "Encoder against command",
  deviation: "Deviation",
  velocity: "Speed",
  angle: "Load angle",
};

interface Props {
  /** oldest first; the last one is drawn in colour */
  runs: readonly Run[];
  view: View;
  band: number | null;
}

/** The newest response, with those before it as ghosts. */
export function ResponsePlot({ runs, view, band }: Props) {
  const scheme = useScheme();
  const newest = runs.at(-1);
  const data = useMemo((): PlotData | undefined => {
    if (!newest) return undefined;
    const { recording } = newest;
    const time = Float64Array.from(recording.time_s);
    const measured = columnOf(recording, view);
    if (view === "deviation" || view === "angle") return [time, measured];
    if (view === "velocity") return [time, measured, columnOf(recording, view, "commanded")];
    const start = originOf(recording);
    const way = wayOf(recording);
    const target = Float64Array.from(recording.target, (value) =>
      value === null ? Number.NaN : way * (value - start),
    );
    return [time, measured, columnOf(recording, view, "commanded"), target];
  }, [newest, view]);
  const ghosts = useMemo(
    () =>
      runs
        .slice(0, -1)
        .reverse()
        .map((run, index): Overlay => {
          const look = GHOSTS[index % GHOSTS.length] ?? { ...PLAIN, dash: [2, 4] };
          return {
            x: run.recording.time_s,
            y: columnOf(run.recording, view),
            color: look[scheme],
            dash: look.dash,
            width: 1.4,
          };
        }),
    [runs, view, scheme],
  );
  const [whole, setWhole] = useState(false);
  const far = useMemo(() => {
    const reaches = runs.map((run) => reachOf([columnOf(run.recording, view)]));
    const places = farOnes(reaches);
    const near = reaches.flatMap((reach, place) => (reach === null || places.includes(place) ? [] : [...reach]));
    const numbers = places.map((place) => runs[place]?.number ?? 0);
    return { numbers, range: roundRange(Math.min(0, ...near), Math.max(0, ...near)) };
  }, [runs, view]);
  if (!newest || !data) return null;
  const series: Record<View, PlotSeries[]> = {
    position: [
      { label: `encoder #${newest.number}`, color: colorOf("encoder_position", scheme), unit: "microsteps", width: 2 },
      { label: "commanded", color: colorOf("position", scheme), unit: "microsteps" },
      { label: "target", color: colorOf("target_position", scheme), unit: "microsteps", dash: [4, 3], stepped: true },
    ],
    deviation: [
      { label: `deviation #${newest.number}`, color: colorOf("deviation", scheme), unit: "microsteps", width: 2 },
    ],
    velocity: [
      { label: `encoder #${newest.number}`, color: colorOf("encoder_velocity", scheme), unit: "pps", width: 2 },
      { label: "commanded", color: colorOf("velocity", scheme), unit: "pps" },
    ],
    angle: [{ label: `load angle #${newest.number}`, color: colorOf("load_angle", scheme), unit: "deg", width: 2 }],
  };
  const end = finalTarget(newest);
  const levels: Level[] =
    band === null || view === "velocity" || view === "angle"
      ? []
      : [band, -band].map((y) => ({
          id: `band${y}`,
          y: (view === "position" ? end : 0) + y,
          color: PLAIN[scheme],
          ...(y > 0 ? { label: "settled" } : {}),
          fixed: true,
        }));
  return (
    <div className="mt-4" data-testid="response-plot" data-runs={runs.length}>
      {far.numbers.length > 0 && (
        <div className="mid lines-8 caution text-12" data-testid="far-runs">
          {far.numbers.length === 1 ? "Run" : "Runs"} {far.numbers.map((number) => `#${number}`).join(", ")}{" "}
          {far.numbers.length === 1 ? "goes" : "go"} far beyond the others
          <Button size="compact-xs" variant="light" aria-pressed={whole} onClick={() => setWhole(!whole)}>
            {whole ? "Show the others closely" : "Show all of it"}
          </Button>
        </div>
      )}
      <Plot
        key={view}
        label={`${NAMES[view]} over the time from the ${newest.kind === "step" ? "step" : "load"}`}
        summary={`Run ${newest.number}${ghosts.length > 0 ? `, with ${ghosts.length} before it` : ""}`}
        series={series[view]}
        data={data}
        overlays={ghosts}
        levels={levels}
        x={{ label: newest.kind === "step" ? "time from the step" : "time from the load", unit: "s" }}
        scales={{
          y: {
            unit: UNITS[view],
            include: [0],
            ...(far.numbers.length > 0 && !whole ? { range: far.range } : {}),
          },
        }}
        height={260}
        legend
      />
    </div>
  );
}

function finalTarget(run: Run): number {
  const last = run.recording.target.findLast((value) => value !== null) ?? 0;
  return Math.abs(last - originOf(run.recording));
}
