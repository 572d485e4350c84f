import { Center } from "@mantine/core";
import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { recordingCursor } from "../../lib/cursor";
import { fixed } from "../../lib/format";
import { Loading } from "../../lib/Loading";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { usePhone } from "../../lib/usePhone";
import { useScheme } from "../../lib/useScheme";
import { LiveText } from "../../live/LiveText";
import { Plot } from "../../plots/Plot";
import type { PlotHandle, WindowChange } from "../../plots/types";
import { fetchPiece, isRunning, type RecordingDetail } from "./api";
import { type Lane, lanesOf, unitText } from "./channels";
import { flagsOf } from "./flags";
import { Overview, type OverviewHandle } from "./Overview";
import { type Piece, type Window, ZoomData } from "./ZoomData";

const OVERVIEW_POINTS = 3000;
/** Range and overview above the plots; between two of them [px] */
const [TOP, GAP] = [87, 4];

interface Props {
  detail: RecordingDetail;
  /** where the plots stand; null: all of it. Set from outside too: by a mark in the list */
  window: Window | null;
  onWindow: (window: Window | null) => void;
  hidden: ReadonlySet<string>;
  /** the first plot stands: what else takes a reading of the file may begin */
  onReady: () => void;
}

/** A wheel turns faster than pages render: the page hears of a window when it has stood still for so long. */
const SETTLED_MS = 150;

/** The plots of one recording, which zoom together, above them where in the whole they are. */
export function RecordingPlots({ detail, window, onWindow, hidden, onReady }: Props) {
  const scheme = useScheme();
  const phone = usePhone();
  const { id, channels } = detail;
  const lanes = useMemo(
    () =>
      lanesOf(channels, scheme)
        .map((lane) => shown(lane, hidden))
        .filter((lane) => lane.columns.length > 0),
    [channels, scheme, hidden],
  );
  const handles = useRef(new Map<string, PlotHandle | null>());
  const drawn = useRef(new Map<string, { handle: PlotHandle; piece: Piece; lane: Lane }>());
  const [loaded, setLoaded] = useState<Piece | null>(null);
  const [problem, setProblem] = useState<unknown>(null);
  const at = useRef<Window | null>(window);
  const heard = useRef(window);
  const overview = useRef<OverviewHandle>(null);
  const settling = useRef(0);
  if (heard.current !== window) {
    // set from outside, after what was zoomed here
    clearTimeout(settling.current);
    heard.current = window;
    at.current = window;
  }
  const latestLanes = useRef(lanes);
  latestLanes.current = lanes;

  // Past React: a wheel turns faster than pages render.
  const draw = useCallback((from: ZoomData) => {
    const whole = from.overview;
    if (whole === null) return;
    const view = at.current ?? extentOf(whole);
    const piece = from.best(view) ?? whole;
    let pixels = 0;
    for (const lane of latestLanes.current) {
      const handle = handles.current.get(lane.id);
      if (!handle) continue;
      const before = drawn.current.get(lane.id);
      if (before?.handle !== handle || before.piece !== piece || before.lane !== lane) {
        drawn.current.set(lane.id, { handle, piece, lane });
        handle.setData([piece.x, ...lane.columns.map((column) => piece.columns[column] ?? [])], [view[0], view[1]]);
      } else handle.setWindow(view[0], view[1]);
      pixels = Math.max(pixels, handle.uplot?.over.clientWidth ?? 0);
    }
    overview.current?.show(at.current);
    from.show(view, pixels || 800);
  }, []);

  const data = useMemo(() => {
    const made: ZoomData = new ZoomData(
      (part, points) => fetchPiece(id, part, points),
      () => {
        setProblem(made.problem);
        setLoaded(made.overview);
        draw(made);
      },
    );
    return made;
  }, [id, draw]);

  const rows = detail.rows ?? 0;
  // biome-ignore lint/correctness/useExhaustiveDependencies: as often as it has grown
  useEffect(() => {
    void data.load(OVERVIEW_POINTS);
  }, [data, rows]);
  useEffect(
    () => () => {
      data.end();
      clearTimeout(settling.current);
      recordingCursor.set(null);
    },
    [data],
  );
  // biome-ignore lint/correctness/useExhaustiveDependencies: drawn when the window or the plots are others
  useEffect(() => draw(data), [data, window, lanes, loaded]);
  const latestReady = useRef(onReady);
  latestReady.current = onReady;
  useEffect(() => {
    if (loaded !== null) latestReady.current();
  }, [loaded]);

  const zero = detail.zero_s ?? 0;
  const flags = useMemo(() => flagsOf(detail.marks, zero, scheme), [detail.marks, zero, scheme]);
  const limit = extentOf(loaded);
  const latestFlags = useRef({ flags, limit });
  latestFlags.current = { flags, limit };
  // Always the same functions: a plot draws anew for other ones.
  const [named, unnamed] = useMemo(() => {
    const marks = (words: boolean) => () => latestFlags.current.flags(at.current ?? latestFlags.current.limit, words);
    return [marks(true), marks(false)];
  }, []);
  const changeWindow = (change: WindowChange): boolean => {
    const [first, last] = extentOf(data.overview);
    const next: Window | null =
      change === "reset" || (change.min <= first && change.max >= last) ? null : [change.min, change.max];
    at.current = next;
    draw(data);
    clearTimeout(settling.current);
    settling.current = globalThis.setTimeout(() => {
      heard.current = next;
      onWindow(next);
    }, SETTLED_MS) as unknown as number;
    return true;
  };

  const heightOf = (lane: Lane) => (lane.logic ? 84 : phone ? 210 : Math.max(150, Math.round(560 / lanes.length)));
  if (problem !== null && loaded === null)
    return <ProblemAlert error={problem} doing="Reading the recording" retry={() => void data.load(OVERVIEW_POINTS)} />;
  if (loaded === null)
    return (
      // as high as what comes: what stands below does not move away from a hand that reaches for it
      <Center mih={lanes.reduce((height, lane) => height + heightOf(lane) + GAP, TOP)}>
        <Loading label="Reading the recording" />
      </Center>
    );
  if (loaded.x.length === 0)
    return (
      <Center mih={260} className="dim text-13" role="status">
        {isRunning(detail) ? "No sample yet: it waits for its trigger." : "This recording has no samples."}
      </Center>
    );
  return (
    <div className="grid shrink gap-4" data-testid="recording-plots" data-loaded={loaded.x.length}>
      <LiveText
        className="num hint push"
        data-testid="range"
        read={() => {
          const [from, to] = at.current ?? limit;
          return `${fixed(from, 3)} to ${fixed(to, 3)} s${at.current === null ? ", all of it" : ""}`;
        }}
      />
      <Overview
        piece={loaded}
        lane={lanes[0]}
        stack={`recording-${id}`}
        handle={overview}
        onWindow={(next) => changeWindow(next === null ? "reset" : { min: next[0], max: next[1] })}
      />
      {problem !== null && <ProblemAlert error={problem} doing="Zooming" retry={() => draw(data)} />}
      {lanes.map((lane, index) => {
        const bottom = index === lanes.length - 1;
        return (
          <Plot
            key={lane.id}
            label={`${lane.title} of the recording over time${lane.unit ? ` in ${unitText(lane.unit)}` : ""}`}
            series={lane.series}
            x={{ label: "time", unit: "s", axis: bottom }}
            scales={{ y: { unit: lane.unit, ...(lane.logic ? { range: [-0.1, 1.1] as const } : {}) } }}
            height={heightOf(lane)}
            group={`recording-${id}`}
            legend
            limit={limit}
            handle={(handle) => {
              handles.current.set(lane.id, handle);
            }}
            marks={index === 0 ? named : unnamed}
            onWindow={changeWindow}
            onCursor={(cursor) => {
              if (cursor !== null) recordingCursor.set({ recording: id, time_s: cursor.x });
            }}
          />
        );
      })}
    </div>
  );
}

function extentOf(whole: Piece | null): Window {
  return [whole?.x[0] ?? 0, whole?.x.at(-1) ?? 1];
}

function shown(lane: Lane, hidden: ReadonlySet<string>): Lane {
  const wanted = lane.series.map((series) => !hidden.has(series.label));
  if (wanted.every(Boolean)) return lane;
  return {
    ...lane,
    columns: lane.columns.filter((_, index) => wanted[index]),
    series: lane.series.filter((_, index) => wanted[index]),
  };
}
