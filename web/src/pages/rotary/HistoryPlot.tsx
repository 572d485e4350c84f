import { Group, SegmentedControl, Select, Text } from "@mantine/core";
import { useEffect, useRef, useState } from "react";
import type { AxisAddress } from "../../api/motion";
import { Card } from "../../lib/Card";
import { colorOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { everyTick } from "../../live/LiveText";
import type { TelemetrySource } from "../../live/TelemetrySource";
import { Plot } from "../../plots/Plot";
import { lowerBound } from "../../plots/series";
import type { PlotHandle, PlotSeries } from "../../plots/types";
import { grouped } from "./exact";
import { type Extended, liveActual, liveEncoder } from "./extended";
import { type Drawn, liveColumns, lookColumns } from "./traces";
import { useHistory } from "./useExtended";

interface Span {
  seconds: number;
  label: string;
  unit: string;
  divisor: number;
}

const SPANS: readonly Span[] = [
  { seconds: 10, label: "10 s", unit: "s", divisor: 1 },
  { seconds: 60, label: "60 s", unit: "s", divisor: 1 },
  { seconds: 600, label: "10 min", unit: "min", divisor: 60 },
  { seconds: 3600, label: "1 h", unit: "h", divisor: 3600 },
  { seconds: 86_400, label: "24 h", unit: "h", divisor: 3600 },
];
/** Up to this span the samples of this page tell more than the looks that the server kept. */
const LIVE_S = 60;

interface Props {
  at: AxisAddress;
  source: TelemetrySource;
  seen: Extended | null;
  connected: boolean;
}

/** Where the shaft was: as angle, or as turns; told and seen. */
export function HistoryPlot({ at, source, seen, connected }: Props) {
  const scheme = useScheme();
  const [seconds, setSeconds] = useState(60);
  const [what, setWhat] = useState<"angle" | "turns">("turns");
  const [note, setNote] = useState("");
  const span = SPANS.find((candidate) => candidate.seconds === seconds) ?? (SPANS[0] as Span);
  const handle = useRef<PlotHandle | null>(null);
  const live = seconds <= LIVE_S;
  const watching = seen?.answer.watching ?? false;
  const history = useHistory(at, seconds, connected && watching && !live);
  const hasEncoder = seen !== null && seen.encoder !== null;
  const latest = useRef({ seen, span, what, data: history.data });
  latest.current = { seen, span, what, data: history.data };

  // biome-ignore lint/correctness/useExhaustiveDependencies: another span or quantity starts the drawing anew
  useEffect(() => {
    let drawn = "";
    return everyTick(() => {
      const now = latest.current;
      if (!now.seen?.turn) return;
      let columns: Drawn;
      if (live) {
        const state = `${source.buffer.revision} ${source.buffer.total}`;
        if (drawn === state) return;
        drawn = state;
        const time = source.buffer.times();
        const first = lowerBound(time, source.buffer.lastTime - seconds);
        const of = (name: string) => source.buffer.column(`${name}.${at.axis}`)?.subarray(first) ?? null;
        const last = (name: string) => source.buffer.last(`${name}.${at.axis}`);
        columns = liveColumns({
          time: time.subarray(first),
          counts: of("position"),
          encoderCounts: of("encoder_position"),
          bits: now.seen.answer.counter_bits ?? 32,
          actual: liveActual(now.seen, last("position")),
          encoder: liveEncoder(now.seen, last("position"), last("encoder_position")),
          turn: now.seen.turn,
          what: now.what,
          divisor: now.span.divisor,
        });
      } else {
        const data = now.data;
        const state = `${data?.time_s.length} ${data?.time_s.at(-1)}`;
        if (drawn === state || data === undefined) return;
        drawn = state;
        columns = lookColumns(data, now.seen.turn, now.what, now.span.divisor);
      }
      handle.current?.setData(
        hasEncoder ? [columns.x, columns.commanded, columns.encoder] : [columns.x, columns.commanded],
        [-seconds / span.divisor, 0],
      );
      setNote(
        columns.fast
          ? "It turns half a turn or more between looks: angles there mean little."
          : sinceText(columns.since),
      );
    });
  }, [live, seconds, what, source, at.axis, hasEncoder]);

  const unit = what === "angle" ? "deg" : "turns";
  const series: PlotSeries[] = [
    { label: "commanded", color: colorOf("position", scheme), unit, width: 2 },
    ...(hasEncoder ? [{ label: "encoder", color: colorOf("encoder_position", scheme), unit }] : []),
  ];
  return (
    <Card
      title="History"
      note={note}
      actions={
        <Group gap={6}>
          <SegmentedControl
            aria-label="Shown as"
            data={["turns", "angle"]}
            value={what}
            onChange={(value) => setWhat(value as "angle" | "turns")}
          />
          <Select
            w={84}
            aria-label="Time span"
            data={SPANS.map(({ seconds: value, label }) => ({ value: String(value), label }))}
            value={String(seconds)}
            onChange={(value) => value && setSeconds(Number(value))}
            data-testid="history-span"
          />
        </Group>
      }
    >
      {seen?.turn ? (
        <Plot
          label={`${what === "angle" ? "Angle" : "Turns"} over time`}
          series={series}
          legend
          x={{ label: "before now", unit: span.unit }}
          scales={{ y: what === "angle" ? ANGLE : TURNS }}
          height={186}
          handle={handle}
        />
      ) : (
        <Text className="hint" role="status">
          Once a turn is set, its angle is kept here while the server runs.
        </Text>
      )}
    </Card>
  );
}

const ANGLE = { unit: "deg", range: [0, 360] as const, at: [0, 90, 180, 270, 360] };
const TURNS = { unit: "turns" };

function sinceText(since: bigint): string {
  return since === 0n ? "" : `turns since ${grouped(since)}`;
}
