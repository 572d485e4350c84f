import { Button, Text } from "@mantine/core";
import { useRef } from "react";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { colorOf } from "../../lib/palette";
import type { Settings } from "../../lib/rows/settings";
import { useScheme } from "../../lib/useScheme";
import { LiveText } from "../../live/LiveText";
import { useFrame } from "../../live/useFrame";
import { Plot } from "../../plots/Plot";
import type { Level, Mark, Overlay, PlotHandle, PlotSeries } from "../../plots/types";
import { type CurrentScale, currentOf, topOf } from "./load";
import { AP } from "./names";
import { SPEED_BINS, type SpeedMap } from "./speedMap";
import { hysteresisFor, LOAD_MAX, lowerLoad, startFor, upperLoad } from "./thresholds";

interface Props {
  map: SpeedMap;
  settings: Settings;
  current: CurrentScale;
  /** the thresholds of speed that are drawn, and what each is called; null while speeds are not in pps */
  lines: Partial<Record<Line, string>> | null;
  /** the newest sample; NaN while unknown */
  now: () => { speed: number; load: number };
}

const INKS = {
  [AP.stealthBelow]: { light: "#008060", dark: "#0f8f6c" },
  [AP.coolOn]: { light: "#0068a8", dark: "#2d86c4" },
  [AP.coolOff]: { light: "#4f5b69", dark: "#6b7480" },
  [AP.stopOnStall]: { light: "#d02828", dark: "#d92d2d" },
} as const;
export type Line = keyof typeof INKS;

/** Load value and current over speed, as they gather, with every threshold that lies there. */
export function SpeedPlot({ map, settings, current, lines, now }: Props) {
  const scheme = useScheme();
  const plot = useRef<PlotHandle | null>(null);
  const drawn = useRef("");
  const lastMs = useRef(0);

  useFrame((nowMs) => {
    if (nowMs - lastMs.current < 100) return;
    const here = now();
    const state = `${map.revision} ${current.step} ${here.speed} ${here.load}`;
    if (state === drawn.current) return;
    drawn.current = state;
    lastMs.current = nowMs;
    const x = Float64Array.from({ length: SPEED_BINS }, (_, bin) => ((bin + 0.5) * map.top) / SPEED_BINS);
    const where = (bins: typeof map.load, value: (bin: number) => number) =>
      x.map((_, bin) => ((bins.count[bin] as number) === 0 ? Number.NaN : value(bin)));
    const uplot = plot.current?.uplot;
    const shown = uplot?.scales.x;
    const whole = shown?.min == null || shown.max == null || shown.min <= 0;
    plot.current?.setData(
      [
        x,
        where(map.load, (bin) => map.load.mean[bin] as number),
        where(map.scale, (bin) => currentOf(map.scale.mean[bin] as number, current)),
      ],
      whole || shown.min == null || shown.max == null ? [0, map.top] : [shown.min, shown.max],
    );
  });

  const overlays = (): Overlay[] => {
    const here = now();
    const dots = { length: map.dots, dots: 2, aside: true };
    return [
      { ...dots, x: map.dotSpeed, y: map.dotLoad, color: `${colorOf("load_value", scheme)}70` },
      { x: [Math.abs(here.speed)], y: [here.load], dots: 8, aside: true, color: colorOf("load_value", scheme) },
    ];
  };
  const marks = (Object.entries(lines ?? {}) as [Line, string][]).flatMap(([name, label]): Mark[] => {
    const at = settings.planned(name);
    if (at === null || at === 0) return [];
    const staged = settings.staged.has(name);
    return [{ id: name, x: at, color: INKS[name][scheme], label: label + (staged ? ", not applied" : "") }];
  });
  const cool = { hysteresisStart: settings.planned(AP.coolStart), hysteresis: settings.planned(AP.coolWidth) };
  const level = (id: string, y: number | null, text: string, name: string): Level[] =>
    y === null
      ? []
      : [
          {
            id,
            y,
            color: INKS[AP.coolOn][scheme],
            label: text + (settings.staged.has(name) ? ", not applied" : ""),
          },
        ];
  const levels = [
    ...level("lower", lowerLoad(cool), "more current below", AP.coolStart),
    ...level("upper", upperLoad(cool), "less current above", AP.coolWidth),
  ];
  const series: PlotSeries[] = [
    { label: "load value, mean", color: colorOf("load_value", scheme), width: 2 },
    { label: "current, mean", color: colorOf("actual_current_scale", scheme), scale: "current", unit: current.symbol },
  ];
  return (
    <Card
      title="Over speed"
      note={<LiveText className="num" read={() => `${fixed(map.load.total)} samples`} data-testid="speed-samples" />}
      actions={
        <Button size="compact-xs" variant="default" onClick={() => map.clear()} data-testid="clear-speed">
          Clear
        </Button>
      }
      className="relative"
    >
      <Plot
        label="Load value and current over speed"
        series={series}
        x={{ label: "speed", unit: "pps" }}
        scales={{
          y: { range: [0, LOAD_MAX + 1] },
          current: {
            side: "right",
            unit: current.symbol,
            range: [0, topOf(current)],
            ticks: (values) => values.map((value) => `${fixed(value, current.decimals)} ${current.symbol}`),
          },
        }}
        height={340}
        limit={[0, Math.max(map.top, 20_000)]}
        handle={(handle) => {
          plot.current = handle;
          drawn.current = "";
        }}
        overlays={overlays}
        marks={marks}
        onMark={(id, x) => settings.stage(id, Math.max(1, Math.round(x / 10) * 10))}
        levels={levels}
        onLevel={(id, y) => {
          if (id === "lower") settings.stage(AP.coolStart, startFor(y));
          else settings.stage(AP.coolWidth, hysteresisFor(y, cool.hysteresisStart ?? 1));
        }}
        onWindow={(change) => {
          if (change === "reset") {
            plot.current?.setWindow(0, map.top);
            return true;
          }
          return undefined;
        }}
      />
      <Text size="xs" c="dimmed">
        The load value falls as the shaft is loaded; 0 is a stall. It means something only in SpreadCycle, and above
        some speed.
      </Text>
    </Card>
  );
}
