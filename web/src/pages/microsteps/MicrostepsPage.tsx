import { ActionIcon, Button, SegmentedControl, Select, Text } from "@mantine/core";
import { useHotkeys, useLocalStorage } from "@mantine/hooks";
import { IconArrowBackUp, IconArrowForwardUp, IconWaveSine } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { type ReactNode, useEffect, useMemo, useState } from "react";
import { api, type Schemas, unwrap } from "../../api/client";
import { type Device, useDevices } from "../../api/queries";
import { EmptyState } from "../../lib/EmptyState";
import { fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Page, Section } from "../../lib/Section";
import { useCalc } from "../../lib/useCalc";
import { useSelection } from "../../live/selection";
import { type Bar, Bars } from "./Bars";
import { ChipPanel } from "./ChipPanel";
import { CurveEditor, type Tool } from "./CurveEditor";
import { FormulaPanel } from "./FormulaPanel";
import { type History, push, redo, settle, start, undo } from "./history";
import { Metrics } from "./Metrics";
import classes from "./Microsteps.module.css";
import { MslutEditor } from "./mslut/MslutEditor";
import { Transfer } from "./Transfer";
import { type Draft, type Formula, SINE } from "./table";
import { Waves } from "./Waves";
import { XyFigure } from "./XyFigure";

type Question = Schemas["MicrostepDesign"];
type Result = Schemas["MicrostepResult"];

/** Drafts outlive the page, not a reload: what matters by then is in the chip, or copied. */
const kept = new Map<string, History<Draft>>();

function useDesign(body: Partial<Question> | null) {
  return useCalc<Partial<Question>, Result>("microstep-table", body, async (question, signal) => {
    const answer = unwrap(await api.POST("/api/v1/calc/microstep-table", { body: question as Question, signal }));
    return answer as Result;
  });
}

/** Round ticks around zero for errors up to `most`. */
export function symmetricScale(most: number): { low: number; high: number; ticks: number[] } {
  const steps = [0.5, 1, 2, 5, 10, 20, 45, 90, 180];
  const high = steps.find((step) => step >= most) ?? 180;
  return { low: -high, high, ticks: [-high, -high / 2, 0, high / 2, high] };
}

/** The table of a TMC428. `choice` stands where no chip decides which table it is. */
function QuarterEditor({ device, axis, choice }: { device: Device | undefined; axis: number; choice?: ReactNode }) {
  const id = device?.id ?? "-";
  const connected = device?.state === "connected";
  const [history, setHistory] = useState<History<Draft>>(
    () => kept.get(id) ?? start<Draft>({ kind: "formula", formula: SINE }),
  );
  useEffect(() => void kept.set(id, history), [id, history]);
  const [tool, setTool] = useState<Tool>("drag");
  const [last, setLast] = useState<Formula>(SINE);
  const [view, setView] = useState<number | null>(null);

  const draft = history.present;
  // a table drawn by hand has no formula: the panel then shows the one that was last
  const formula = draft.kind === "formula" ? draft.formula : last;

  const chip = useQuery({
    queryKey: ["microstep-table", id],
    queryFn: async ({ signal }) =>
      unwrap(await api.GET("/api/v1/devices/{device}/microstep-table", { params: { path: { device: id } }, signal })),
    enabled: connected,
    refetchInterval: 3000,
  });
  const held = chip.data?.values ?? null;

  const microsteps = device?.axes[axis]?.microsteps_per_full_step ?? 64;
  const chipUsrs = Math.min(6, Math.max(0, Math.round(Math.log2(microsteps))));
  const usrs = view ?? chipUsrs;

  const design = useDesign(draft.kind === "values" ? { values: draft.values, usrs } : { ...draft.formula, usrs });
  const before = useDesign(held === null ? null : { values: held, usrs });
  const values = draft.kind === "values" ? draft.values : (design.result?.values ?? null);
  const result = design.result;
  const old = held === null ? null : (before.result ?? null);

  const change = (next: Draft, tag: string | null) => setHistory((now) => push(now, next, tag));
  const rest = () => setHistory(settle);
  const back = () => setHistory(undo);
  const forth = () => setHistory(redo);
  useHotkeys([
    ["mod+Z", back],
    ["mod+shift+Z", forth],
    ["mod+Y", forth],
  ]);

  const errorBars = useMemo<Bar[]>(() => {
    const earlier = old?.metrics.angle_error_deg ?? [];
    return (result?.metrics.angle_error_deg ?? []).map((value, index) => ({
      label: `step ${index}`,
      value,
      before: earlier.length === result?.metrics.angle_error_deg.length ? (earlier[index] ?? null) : null,
    }));
  }, [result, old]);
  const most = errorBars.reduce(
    (high, bar) => Math.max(high, Math.abs(bar.value ?? 0), Math.abs(bar.before ?? 0)),
    0.1,
  );
  const worstAngle = useMemo(() => {
    let worst: number | null = null;
    let size = 1e-9;
    errorBars.forEach((bar, index) => {
      // the first of equals: every quarter repeats the extreme
      if (Math.abs(bar.value ?? 0) > size + 1e-9) {
        worst = index;
        size = Math.abs(bar.value ?? 0);
      }
    });
    return worst;
  }, [errorBars]);
  const harmonicBars = useMemo<Bar[]>(
    () =>
      (result?.metrics.harmonics ?? []).slice(1).map((value, index) => ({
        label: `harmonic ${index + 2}`,
        value: value * 100,
        before: old ? (old.metrics.harmonics[index + 1] ?? 0) * 100 : null,
      })),
    [result, old],
  );
  const worstHarmonic = harmonicBars.reduce<number | null>(
    (worst, bar, index) =>
      worst === null || (bar.value ?? 0) > (harmonicBars[worst]?.value ?? 0) + 1e-9 ? index : worst,
    null,
  );
  const stale = design.stale ? "stale" : "";

  return (
    <Page name="Microsteps">
      {choice}
      {chip.isError && connected && (
        <ProblemAlert
          error={chip.error}
          doing={`Reading the table of ${device?.name}`}
          retry={() => void chip.refetch()}
        />
      )}
      <div className={classes.page}>
        <div className={classes.column}>
          <Section
            title="Quarter wave"
            note={
              <span className={classes.legend}>
                <i data-kind="design" /> design <i data-kind="before" /> chip <i data-kind="ideal" /> sine
              </span>
            }
            actions={
              <>
                <SegmentedControl
                  size="xs"
                  aria-label="Pointer"
                  value={tool}
                  onChange={(next) => setTool(next as Tool)}
                  data={[
                    { value: "drag", label: "drag a point" },
                    { value: "draw", label: "draw freely" },
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
            {values ? (
              <CurveEditor
                values={values}
                before={held}
                tool={tool}
                onChange={(next, tag) => change({ kind: "values", values: next, origin: "hand" }, tag)}
                onSettle={rest}
              />
            ) : (
              <div className={classes.waiting}>{design.error ? "" : "designing the table"}</div>
            )}
            <FormulaPanel
              formula={formula}
              active={draft.kind === "formula"}
              onChange={(next, tag) => {
                setLast(next);
                change({ kind: "formula", formula: next }, tag);
              }}
              onSettle={rest}
            />
          </Section>
          <ChipPanel
            device={device}
            axis={axis}
            held={held}
            values={values}
            stale={draft.kind === "formula" && design.stale}
            onRead={() => held && change({ kind: "values", values: [...held], origin: "chip" }, null)}
          />
          <Section
            title="In and out"
            actions={
              <Transfer
                values={values}
                onPaste={(next) => change({ kind: "values", values: next, origin: "pasted" }, null)}
              />
            }
          >
            <p className={`num ${classes.numbers} ${draft.kind === "formula" ? stale : ""}`}>
              {values?.map((value) => String(value).padStart(2, "\u2007")).join(" ") ?? " "}
            </p>
          </Section>
        </div>
        <div className={classes.column}>
          <Section
            title="Phase currents"
            note="one electrical period, four full steps"
            actions={
              <>
                <span className={classes.hint}>
                  {usrs === chipUsrs ? "as the chip is set" : "not as the chip is set"}
                </span>
                <Select
                  aria-label="Resolution shown"
                  size="xs"
                  w={190}
                  allowDeselect={false}
                  value={String(usrs)}
                  onChange={(next) => setView(next === null || Number(next) === chipUsrs ? null : Number(next))}
                  data={Array.from({ length: 7 }, (_, step) => ({
                    value: String(step),
                    label: step === 0 ? "full steps" : `${2 ** step} µsteps / full step`,
                  }))}
                />
              </>
            }
          >
            {design.error !== null && (
              <ProblemAlert error={design.error} doing="Designing the table" retry={design.retry} />
            )}
            <div className={classes.pair}>
              <div className={stale} aria-busy={design.stale}>
                {result ? (
                  <Waves rows={result.sequence} before={old?.sequence ?? null} />
                ) : (
                  <div className={classes.waiting} />
                )}
              </div>
              <div className={`${classes.xyBox} ${stale}`}>
                {result && (
                  <XyFigure rows={result.sequence} before={old?.sequence ?? null} worst={result.metrics.worst_step} />
                )}
                <p className={classes.hint}>
                  {result?.metrics.worst_step == null
                    ? "current vector"
                    : `orange: the longest step, ${fixed(result.metrics.worst_step_ratio, 2)} × ideal`}
                </p>
              </div>
            </div>
            {result?.warnings.map((warning) => (
              <p key={warning} className={classes.caution}>
                {warning}
              </p>
            ))}
          </Section>
          <div className={classes.two}>
            <Section title="Angle error" note="electrical, each microstep">
              <div className={stale}>
                <Bars
                  label="Angle error of each microstep"
                  bars={errorBars}
                  scale={symmetricScale(most)}
                  format={(value) => (value === null ? "no current" : `${fixed(value, 2)}°`)}
                  marked={worstAngle}
                  every={Math.max(1, errorBars.length / 8)}
                />
              </div>
            </Section>
            <Section title="Harmonics" note="of the first, logarithmic">
              <div className={stale}>
                <Bars
                  label="Harmonics of the phase current"
                  bars={harmonicBars}
                  scale={{ low: 0.01, high: 100, ticks: [0.01, 0.1, 1, 10, 100], log: true }}
                  format={(value) =>
                    value === null ? "–" : `${fixed(value, value >= 10 ? 0 : value >= 0.1 ? 1 : 2)} %`
                  }
                  marked={worstHarmonic}
                  every={1}
                />
              </div>
            </Section>
          </div>
          <Section title="Before and after" note={`at ${2 ** usrs} microsteps per full step`}>
            <div className={stale}>
              {result ? <Metrics before={old?.metrics ?? null} after={result.metrics} /> : null}
            </div>
          </Section>
        </div>
      </div>
    </Page>
  );
}

type Format = "quarter" | "mslut";

/** Which table is designed while no chip decides. */
function FormatChoice({ format, onFormat }: { format: Format; onFormat: (format: Format) => void }) {
  return (
    <div className={classes.choice}>
      <span className={classes.hint}>Design without a device, for</span>
      <SegmentedControl
        size="xs"
        aria-label="Kind of table"
        value={format}
        onChange={(next) => onFormat(next as Format)}
        data={[
          { value: "quarter", label: "TMC428, 64 values" },
          { value: "mslut", label: "TMC4361, 256 differences" },
        ]}
      />
    </div>
  );
}

/** What to do where there is no table to design. */
function NoTable({
  device,
  others,
  onOther,
}: {
  device: Device;
  others: readonly Device[];
  onOther: (other: Device) => void;
}) {
  return (
    <EmptyState title={`${device.name} has no microstep table`} icon={<IconWaveSine size={24} />}>
      <Text size="sm" maw={560}>
        The TMC4210 gives out step and direction; the currents of the microsteps are made by the driver behind it. Its
        resolution is set there (now {device.axes[0]?.driver_microsteps ?? 16} microsteps per full step, under
        Connections), and its wave, where it can be changed, in the driver's own table.
      </Text>
      {others.slice(0, 3).map((other) => (
        <Button key={other.id} size="xs" onClick={() => onOther(other)}>
          Show the {other.title} {other.name}
        </Button>
      ))}
      {others.length === 0 && <Text size="sm">Add a TMC428 or a TMC4361 under Connections to design a table.</Text>}
    </EmptyState>
  );
}

/** Microsteps: the wave of a chip's table, what it does to the currents, and the way into the chip. */
export default function MicrostepsPage() {
  const devices = useDevices();
  const { device, axis, select } = useSelection();
  const [wanted, setWanted] = useLocalStorage<Format>({
    key: "stepscope.microsteps.format",
    defaultValue: "quarter",
    getInitialValueInEffect: false,
  });
  if (devices.isPending) return null;
  if (device?.model === "tmc4210") {
    const others = devices.data?.filter(({ model }) => model === "tmc428" || model === "tmc4361") ?? [];
    return (
      <Page name="Microsteps">
        <NoTable device={device} others={others} onOther={(other) => select(other.id, 0)} />
      </Page>
    );
  }
  const format: Format = device === undefined ? wanted : device.model === "tmc4361" ? "mslut" : "quarter";
  const Editor = format === "mslut" ? MslutEditor : QuarterEditor;
  return (
    <Editor
      key={device?.id ?? "-"}
      device={device}
      axis={axis}
      choice={device === undefined && <FormatChoice format={wanted} onFormat={setWanted} />}
    />
  );
}
