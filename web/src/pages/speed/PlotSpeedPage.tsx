import { Group, SimpleGrid, Stack, Text, Title } from "@mantine/core";
import { useRef, useState } from "react";
import { fixed } from "../../lib/format";
import { colorOf, type Quantity } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { TraceBuffer } from "../../live/TraceBuffer";
import { useFrame } from "../../live/useFrame";
import { cut } from "../../live/window";
import { Plot } from "../../plots/Plot";
import type { PlotHandle, PlotSeries } from "../../plots/types";
import { Pace } from "./pace";

const PLOTS = 4;
const POINTS = 20_000;
const RATE_HZ = 1000;
const QUANTITIES: readonly Quantity[] = ["position", "target_position", "predicted_position"];

/** Rows as a device at 1 kHz would send them, from `from` on: three waves, each plot's of its own period. */
function rows(from: number, count: number, plot: number) {
  const time = Float64Array.from({ length: count }, (_, row) => (from + row) / RATE_HZ);
  const columns = QUANTITIES.map((_, series) =>
    time.map((at) => 1000 * Math.sin(at * (1 + plot) + series) + 40 * Math.sin(at * 61 + series * plot)),
  );
  return { sequence: 0, dropped: 0, rows: count, time, columns };
}

/**
 * How fast this browser draws: four live plots of three series with 20,000 visible points each, new samples in every
 * frame. Not in the menu: `make bench` reads its figures, and who finds the scope slow can look here.
 */
export default function PlotSpeedPage() {
  const scheme = useScheme();
  const handles = useRef<(PlotHandle | null)[]>([]);
  const buffers = useRef<TraceBuffer[]>(null);
  const pace = useRef(new Pace());
  const [figures, setFigures] = useState<ReturnType<Pace["figures"]>>(null);

  if (buffers.current === null) {
    buffers.current = Array.from({ length: PLOTS }, (_, plot) => {
      const buffer = new TraceBuffer([...QUANTITIES], POINTS);
      buffer.append(rows(0, POINTS, plot));
      return buffer;
    });
  }

  useFrame((nowMs) => {
    const startMs = performance.now();
    const fresh = pace.current.rowsDue(nowMs, RATE_HZ);
    buffers.current?.forEach((buffer, plot) => {
      if (fresh > 0) buffer.append(rows(buffer.total, fresh, plot));
      const to = buffer.lastTime;
      const from = to - (POINTS - 1) / RATE_HZ;
      const traces = QUANTITIES.map((channel) => ({ channel, divisor: 1 }));
      const { x, columns } = cut(buffer, traces, from, to);
      handles.current[plot]?.setData([x, ...columns], [from, to]);
    });
    pace.current.frame(nowMs, performance.now() - startMs);
    if (pace.current.frames % 60 === 0) setFigures(pace.current.figures());
  });

  const series: PlotSeries[] = QUANTITIES.map((quantity) => ({
    label: quantity.replace("_", " "),
    color: colorOf(quantity, scheme),
  }));
  return (
    <Stack gap="xs">
      <Title order={1} size="h4">
        Drawing speed
      </Title>
      <Group gap="lg" data-testid="plot-speed" data-figures={JSON.stringify(figures)}>
        <Text size="sm">
          {PLOTS} plots, {QUANTITIES.length} series, {fixed(POINTS)} points each
        </Text>
        <Text size="sm" ff="monospace">
          {figures
            ? `${fixed(figures.fps, 1)} frames/s, script ${fixed(figures.scriptMs, 1, "ms")} a frame`
            : "measuring"}
        </Text>
      </Group>
      <SimpleGrid cols={{ base: 1, md: 2 }} spacing="xs">
        {Array.from({ length: PLOTS }, (_, plot) => (
          <Plot
            // biome-ignore lint/suspicious/noArrayIndexKey: the plots never change places
            key={plot}
            label={`Plot ${plot + 1}`}
            series={series}
            height="38vh"
            handle={(handle) => {
              handles.current[plot] = handle;
            }}
          />
        ))}
      </SimpleGrid>
    </Stack>
  );
}
