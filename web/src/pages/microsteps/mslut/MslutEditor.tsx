import { ActionIcon, Button, SegmentedControl, Select } from "@mantine/core";
import { useHotkeys } from "@mantine/hooks";
import { IconArrowBackUp, IconArrowForwardUp, IconArrowsMoveVertical } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { type ReactNode, useCallback, useEffect, useMemo, useState } from "react";
import { api, type Schemas, unwrap } from "../../../api/client";
import type { Device } from "../../../api/queries";
import { fixed } from "../../../lib/format";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import { Page, Section } from "../../../lib/Section";
import { useCalc } from "../../../lib/useCalc";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { type Bar, Bars } from "../Bars";
import { type History, push, redo, settle, start, undo } from "../history";
import { asHeld, Chip } from "./Chip";
import { FigureTable } from "./Figures";
import classes from "./Mslut.module.css";
import { Registers } from "./Registers";
import { Seen } from "./seen";
import { MAGNIFIED, VectorFigure } from "./VectorFigure";
import { Watch } from "./Watch";
import { type Tool, type View, WaveEditor } from "./WaveEditor";
import { WavePanel } from "./WavePanel";
import { DEFAULT, type Design, type Draft, type Formula, type Norm, questionOf, SEGMENTS, wordsOf } from "./wave";

type Result = Schemas["MslutResult"];

/** Drafts outlive the page, not a reload: what matters by then is in the chip, or copied. */
const kept = new Map<string, History<Draft>>();

const NORMS: { value: Norm; label: string }[] = [
  { value: "least_squares", label: "least squares" },
  { value: "minimax", label: "smallest worst distance" },
];

function useDesign(body: Partial<Design> | null) {
  return useCalc<Partial<Design>, Result>("microstep-table", body, async (question, signal) => {
    const answer = unwrap(await api.POST("/api/v1/calc/microstep-table", { body: question as Design, signal }));
    return answer as Result;
  });
}

/** The wave of a chip with one-bit differences: designed, judged, and sent. `choice` stands where no chip decides. */
export function MslutEditor({
  device,
  axis,
  choice,
}: {
  device: Device | undefined;
  axis: number;
  choice?: ReactNode;
}) {
  const id = device?.id ?? "-";
  const connected = device?.state === "connected";
  const scheme = useScheme();
  const [history, setHistory] = useState<History<Draft>>(
    () => kept.get(id) ?? start<Draft>({ kind: "formula", formula: DEFAULT }),
  );
  useEffect(() => void kept.set(id, history), [id, history]);
  const [tool, setTool] = useState<Tool>("bend");
  const [view, setView] = useState<View>("quarter");
  const [norm, setNorm] = useState<Norm>("least_squares");
  const [last, setLast] = useState<Formula>(DEFAULT);

  const [seen] = useState(() => new Seen());
  const [count, setCount] = useState({ places: 0, wrong: 0 });
  const onCount = useCallback((places: number, wrong: number) => setCount({ places, wrong }), []);

  const draft = history.present;
  // a wave drawn by hand has no formula: the panel then shows the one that was last
  const formula = draft.kind === "formula" ? draft.formula : last;

  const chip = useQuery({
    queryKey: ["microstep-table", id],
    queryFn: async ({ signal }) =>
      asHeld(
        unwrap(await api.GET("/api/v1/devices/{device}/microstep-table", { params: { path: { device: id } }, signal })),
      ),
    enabled: connected,
    refetchInterval: 1000,
  });
  const held = chip.data ?? null;

  const question = useMemo(() => questionOf(draft, norm), [draft, norm]);
  const design = useDesign(question);
  // without a chip the power-on wave is what to compare with
  const heldQuestion = useMemo<Partial<Design>>(
    () => (held ? { chip: "tmc4361", registers: wordsOf(held.registers) } : { chip: "tmc4361" }),
    [held],
  );
  const old = useDesign(heldQuestion).result ?? null;
  const result = design.result ?? null;
  const wave = draft.kind === "values" ? draft : result && { values: result.values, mirror: result.mirror };
  const answered = !design.stale && result !== null;
  const table = answered ? result.table : null;
  const before = held ?? old;
  const beforeWave = useMemo(() => before && { values: before.values, mirror: before.mirror }, [before]);
  const beforeName = held ? "chip" : "power-on";

  const change = (next: Draft, tag: string | null) => setHistory((now) => push(now, next, tag));
  const rest = () => setHistory(settle);
  const back = () => setHistory(undo);
  const forth = () => setHistory(redo);
  useHotkeys([
    ["mod+Z", back],
    ["mod+shift+Z", forth],
    ["mod+Y", forth],
  ]);

  const places = useMemo(() => Array.from({ length: 256 }, (_, place) => place), []);
  const nothing = useMemo(() => places.map(() => Number.NaN), [places]);
  const angles = useMemo(
    () => [places, old?.metrics.angle_error_deg ?? nothing, result?.metrics.angle_error_deg ?? nothing] as const,
    [places, nothing, old, result],
  );
  const harmonicBars = useMemo<Bar[]>(
    () =>
      [3, 5, 7, 9, 11, 13, 15].map((number) => ({
        label: `harmonic ${number}`,
        value: (result?.metrics.harmonics?.[number - 1] ?? 0) * 100,
        before: old?.metrics.harmonics ? (old.metrics.harmonics[number - 1] ?? 0) * 100 : null,
      })),
    [result, old],
  );
  const worstHarmonic = harmonicBars.reduce(
    (worst, bar, index) => ((bar.value ?? 0) > (harmonicBars[worst]?.value ?? 0) + 1e-9 ? index : worst),
    0,
  );
  const stale = design.stale ? "stale" : "";
  const blue = colorOf("phase_a", scheme);
  const grey = colorOf("target_position", scheme);

  return (
    <Page name="Microsteps">
      {choice}
      {device && held && connected && <Watch device={device} axis={axis} held={held} seen={seen} onCount={onCount} />}
      {chip.isError && connected && (
        <ProblemAlert
          error={chip.error}
          doing={`Reading the table of ${device?.name}`}
          retry={() => void chip.refetch()}
        />
      )}
      <div className={classes.page}>
        <Section
          title="Wave"
          note={
            <span className={classes.legend}>
              <i data-kind="design" /> {view === "period" ? "phase A" : "design"}
              {view === "period" && (
                <>
                  <i data-kind="phase_b" /> phase B
                </>
              )}
              <i data-kind="before" /> {beforeName} <i data-kind="ideal" /> sine
              {count.places > 4 && (
                <>
                  <i data-kind="seen" /> seen
                </>
              )}
              {result?.nearest && (
                <>
                  <i data-kind="nearest" /> nearest
                </>
              )}
            </span>
          }
          actions={
            <>
              <SegmentedControl
                size="xs"
                aria-label="Positions shown"
                value={view}
                onChange={(next) => setView(next as View)}
                data={[
                  { value: "quarter", label: "quarter, 256" },
                  { value: "period", label: "period, 1024" },
                ]}
              />
              <SegmentedControl
                size="xs"
                aria-label="Pointer"
                value={tool}
                onChange={(next) => setTool(next as Tool)}
                data={[
                  { value: "bend", label: "bend" },
                  { value: "point", label: "one entry" },
                  { value: "draw", label: "draw" },
                ]}
              />
              <ActionIcon
                variant="default"
                aria-label="Undo"
                title="Undo, Ctrl+Z"
                disabled={history.past.length === 0}
                onClick={back}
              >
                <IconArrowBackUp size={16} />
              </ActionIcon>
              <ActionIcon
                variant="default"
                aria-label="Redo"
                title="Redo, Ctrl+Shift+Z"
                disabled={history.future.length === 0}
                onClick={forth}
              >
                <IconArrowForwardUp size={16} />
              </ActionIcon>
            </>
          }
        >
          {wave ? (
            <WaveEditor
              values={wave.values}
              mirror={wave.mirror}
              view={view}
              tool={tool}
              segments={(result?.table ?? result?.nearest?.table)?.segments ?? []}
              refusals={result?.refusals ?? []}
              nearest={result?.nearest?.table ?? null}
              before={beforeWave}
              beforeName={beforeName}
              live={held}
              seen={seen}
              onChange={(values, tag) => change({ kind: "values", values, mirror: wave.mirror, origin: "hand" }, tag)}
              onSettle={rest}
            />
          ) : (
            <div className={classes.waiting} />
          )}
          {design.error !== null && (
            <ProblemAlert error={design.error} doing="Designing the wave" retry={design.retry} />
          )}
          <Verdict
            result={result}
            norm={norm}
            onNorm={setNorm}
            onNearest={(nearest) =>
              change({ kind: "values", values: [...nearest.values], mirror: nearest.mirror, origin: "nearest" }, null)
            }
          />
          <p className={classes.warnings}>{[...new Set(result?.warnings ?? [])].join(". ")}</p>
        </Section>
        <div className={classes.columns}>
          <div className={classes.column}>
            <Section title="Formula">
              <WavePanel
                formula={formula}
                active={draft.kind === "formula"}
                onChange={(next, tag) => {
                  setLast(next);
                  change({ kind: "formula", formula: next }, tag);
                }}
                onSettle={rest}
              />
            </Section>
            <Chip
              device={device}
              axis={axis}
              held={held}
              seen={count}
              table={table}
              stale={design.stale}
              onRead={() =>
                held && change({ kind: "values", values: [...held.values], mirror: held.mirror, origin: "chip" }, null)
              }
            />
          </div>
          <div className={classes.column}>
            <Section title="Before and after" note="one electrical period; angles electrical, microsteps 1/1024 of it">
              <div className={classes.pair}>
                <div className={stale}>
                  {result && (
                    <FigureTable before={old?.metrics ?? null} beforeName={beforeName} after={result.metrics} />
                  )}
                </div>
                <div className={`${classes.xyBox} ${stale}`}>
                  {wave && (
                    <VectorFigure design={wave} before={beforeWave} worst={result?.metrics.worst_position ?? null} />
                  )}
                  <p className={classes.hint}>
                    current vector, its length’s deviation × {MAGNIFIED}; orange: worst angle
                  </p>
                </div>
              </div>
            </Section>
            <div className={classes.two}>
              <Section title="Angle error" note="electrical, each microstep of a quarter">
                <div className={stale}>
                  <Plot
                    label="Angle error of each microstep of a quarter"
                    series={[
                      { label: beforeName, color: grey, unit: "deg" },
                      { label: "design", color: blue, unit: "deg", width: 1.5 },
                    ]}
                    data={angles}
                    height={170}
                    limit={[0, 255]}
                    x={{ at: [0, 64, 128, 192, 255] }}
                    scales={{ y: { include: [-0.25, 0, 0.25] } }}
                  />
                </div>
              </Section>
              <Section title="Harmonics" note="of the first, logarithmic">
                <div className={stale}>
                  <Bars
                    label="Harmonics of the phase current"
                    bars={harmonicBars}
                    height={174}
                    scale={{ low: 0.01, high: 100, ticks: [0.01, 0.1, 1, 10, 100], log: true }}
                    format={(value) =>
                      value === null
                        ? "–"
                        : `${fixed(value, value >= 10 ? 0 : value >= 0.1 ? 1 : value >= 0.01 ? 2 : 3)} %`
                    }
                    marked={worstHarmonic}
                    every={1}
                  />
                </div>
              </Section>
            </div>
            <Registers
              table={result?.table ?? null}
              held={held}
              onPaste={(values, mirror) => change({ kind: "values", values, mirror, origin: "pasted" }, null)}
            />
          </div>
        </div>
      </div>
    </Page>
  );
}

interface VerdictProps {
  result: Result | null;
  norm: Norm;
  onNorm: (norm: Norm) => void;
  onNearest: (table: Schemas["MslutTable"]) => void;
}

/** Can the registers hold it? If not: where, why, and the nearest wave that they can. */
function Verdict({ result, norm, onNorm, onNearest }: VerdictProps) {
  const [first, ...more] = result?.refusals ?? [];
  if (first === undefined || !result) {
    const segments = result?.table?.segments.length;
    return (
      <div className={classes.verdict} role="status">
        {segments !== undefined && (
          <p>
            Encodable, exactly, in {segments} of {SEGMENTS} segments.
          </p>
        )}
      </div>
    );
  }
  const { nearest } = result;
  return (
    <div className={classes.verdict} role="status" data-refused>
      <p>
        Cannot be encoded at entry {first.index}: {first.detail}.
        {more.length > 0 && (
          <span className={classes.dim}>
            {more.length === 1 ? " One more place is" : ` ${more.length} more places are`} marked.
          </span>
        )}
      </p>
      {nearest && (
        <>
          <span className={classes.dim}>
            nearest: <span className="num">{fixed(nearest.distance_rms, 2)}</span> counts rms,{" "}
            <span className="num">{fixed(nearest.distance_max, 1)}</span> at most
          </span>
          <Select
            size="xs"
            w={190}
            aria-label="Nearest by"
            allowDeselect={false}
            value={norm}
            onChange={(next) => next && onNorm(next as Norm)}
            data={NORMS}
          />
          <Button
            size="xs"
            leftSection={<IconArrowsMoveVertical size={14} aria-hidden />}
            onClick={() => onNearest(nearest.table)}
          >
            Take the nearest
          </Button>
        </>
      )}
    </div>
  );
}
