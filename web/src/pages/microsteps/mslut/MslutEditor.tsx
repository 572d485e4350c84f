import { Anchor, Button, Center, SegmentedControl, Select } from "@mantine/core";
import { IconArrowsMoveVertical } from "@tabler/icons-react";
import { type ReactNode, useCallback, useMemo, useState } from "react";
import { Link } from "wouter";
import type { Schemas } from "../../../api/client";
import { can, type Device, useCatalog } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { optionsOf } from "../../../lib/choices";
import { fixed } from "../../../lib/format";
import { UndoRedo } from "../../../lib/history/UndoRedo";
import { Page } from "../../../lib/Page";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { Harmonics } from "../Harmonics";
import { useDraft } from "../useDraft";
import { useDesign, useHeld } from "../useTable";
import { asHeld, Chip } from "./Chip";
import { FigureTable } from "./Figures";
import classes from "./Mslut.module.css";
import { Registers } from "./Registers";
import { Seen } from "./seen";
import { MAGNIFIED, VectorFigure } from "./VectorFigure";
import { Watch } from "./Watch";
import { type Tool, type View, WaveEditor } from "./WaveEditor";
import { WavePanel } from "./WavePanel";
import {
  DEFAULT,
  type Design,
  type Draft,
  type Formula,
  type Norm,
  phasesOf,
  questionOf,
  SEGMENTS,
  wordsOf,
} from "./wave";

type Result = Schemas["MslutResult"];

/** The even ones are none: the wave has a negative half of its own. */
const ODD = [3, 5, 7, 9, 11, 13, 15];

const NORMS: { value: Norm; label: string }[] = optionsOf({
  least_squares: "least squares",
  minimax: "smallest worst distance",
});

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
  const catalog = useCatalog();
  const about = device?.about ?? catalog.data?.find(({ capabilities }) => capabilities.includes("microsteps.mslut"));
  const model = about?.name as Design["chip"];
  const phases = phasesOf(about?.family, about?.name);
  const connected = device?.state === "connected";
  const scheme = useScheme();
  const drafting = useDraft<Draft>(`mslut ${device?.id}`, "Wave", { kind: "formula", formula: DEFAULT });
  const [tool, setTool] = useState<Tool>("bend");
  const [view, setView] = useState<View>("quarter");
  const [norm, setNorm] = useState<Norm>("least_squares");
  const [last, setLast] = useState<Formula>(DEFAULT);

  const [seen] = useState(() => new Seen());
  const [count, setCount] = useState({ places: 0, wrong: 0 });
  const onCount = useCallback((places: number, wrong: number) => setCount({ places, wrong }), []);

  const { draft, change, rest } = drafting;
  // a wave drawn by hand has no formula: the panel then shows the one that was last
  const formula = draft.kind === "formula" ? draft.formula : last;

  const chip = useHeld(device, 1000);
  const held = chip.data ? asHeld(chip.data) : null;

  const question = useMemo(() => questionOf(draft, norm, model), [draft, norm, model]);
  const design = useDesign<Design, Result>(question);
  // without a chip the power-on wave is what to compare with
  const heldQuestion = useMemo<Partial<Design>>(
    () => ({ chip: model, ...(held ? { registers: wordsOf(held.registers) } : {}) }),
    [held, model],
  );
  const old = useDesign<Design, Result>(heldQuestion).result ?? null;
  const result = design.result ?? null;
  const wave = draft.kind === "values" ? draft : result && { values: result.values, mirror: result.mirror };
  const answered = !design.stale && result !== null;
  const table = answered ? result.table : null;
  const before = held ?? old;
  const beforeWave = useMemo(() => before && { values: before.values, mirror: before.mirror }, [before]);
  const beforeName = held ? "chip" : "power-on";

  const places = useMemo(() => Array.from({ length: 256 }, (_, place) => place), []);
  const nothing = useMemo(() => places.map(() => Number.NaN), [places]);
  const angles = useMemo(
    () => [places, old?.metrics.angle_error_deg ?? nothing, result?.metrics.angle_error_deg ?? nothing] as const,
    [places, nothing, old, result],
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
      <div className="column">
        <Card
          title="Wave"
          note={
            <span className="inline wrap gap-4">
              <i className="key-line" /> {view === "period" ? phases.sine : "design"}
              {view === "period" && (
                <>
                  <i className="key-line hue-orange ml-4" /> {phases.cosine}
                </>
              )}
              <i className="key-line hue-grey ml-4" /> {beforeName} <i className="key-line key-dashed hue-grey ml-4" />{" "}
              sine
              {count.places > 4 && (
                <>
                  <i className="key-line key-dotted hue-text ml-4" /> seen
                </>
              )}
              {result?.nearest && (
                <>
                  <i className="key-line hue-violet ml-4" /> nearest
                </>
              )}
            </span>
          }
          actions={
            <>
              <SegmentedControl
                aria-label="Positions shown"
                value={view}
                onChange={(next) => setView(next as View)}
                data={optionsOf({ quarter: "quarter, 256", period: "period, 1024" })}
              />
              <SegmentedControl
                aria-label="Pointer"
                value={tool}
                onChange={(next) => setTool(next as Tool)}
                data={optionsOf({ bend: "bend", point: "one entry", draw: "draw" })}
              />
              <UndoRedo />
              {device && can(device, "encoder") && (
                <Anchor size="sm" component={Link} href="/tune?kind=microstep_calibration">
                  By the encoder
                </Anchor>
              )}
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
            <Center mih={430} />
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
          <p className="room m-0 mt-4 caution text-12">{[...new Set(result?.warnings ?? [])].join(". ")}</p>
        </Card>
        <div className="columns design until-75">
          <div className="column">
            <Card title="Formula">
              <WavePanel
                formula={formula}
                active={draft.kind === "formula"}
                onChange={(next, tag) => {
                  setLast(next);
                  change({ kind: "formula", formula: next }, tag);
                }}
                onSettle={rest}
              />
            </Card>
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
          <div className="column">
            <Card title="Before and after" note="one electrical period; angles electrical, microsteps 1/1024 of it">
              <div className={`beside-figure columns gap-12 mid ${classes.compared}`}>
                <div className={stale}>
                  {result && (
                    <FigureTable before={old?.metrics ?? null} beforeName={beforeName} after={result.metrics} />
                  )}
                </div>
                <div className={`centered ${stale}`}>
                  {wave && (
                    <VectorFigure
                      design={wave}
                      before={beforeWave}
                      worst={result?.metrics.worst_position ?? null}
                      phases={phases}
                    />
                  )}
                  <p className="hint m-0 mt-4">
                    current vector, its length’s deviation × {MAGNIFIED}; orange: worst angle
                  </p>
                </div>
              </div>
            </Card>
            <div className="columns">
              <Card title="Angle error" note="electrical, each microstep of a quarter">
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
              </Card>
              <Harmonics
                numbers={ODD}
                design={result?.metrics.harmonics}
                before={old?.metrics.harmonics}
                stale={design.stale}
                height={174}
              />
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
      <div className={`${classes.verdict} lines-8 box mt-4 text-13`} role="status">
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
    <div className={`${classes.verdict} lines-8 box mt-4 text-13`} role="status" data-refused>
      <p>
        Cannot be encoded at entry {first.index}: {first.detail}.
        {more.length > 0 && (
          <span className="dim">
            {more.length === 1 ? " One more place is" : ` ${more.length} more places are`} marked.
          </span>
        )}
      </p>
      {nearest && (
        <>
          <span className="dim">
            nearest: <span className="num">{fixed(nearest.distance_rms, 2)}</span> counts rms,{" "}
            <span className="num">{fixed(nearest.distance_max, 1)}</span> at most
          </span>
          <Select
            w={190}
            aria-label="Nearest by"
            value={norm}
            onChange={(next) => next && onNorm(next as Norm)}
            data={NORMS}
          />
          <Button
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
