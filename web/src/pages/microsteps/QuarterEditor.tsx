import { SegmentedControl, Select } from "@mantine/core";
import { type ReactNode, useMemo, useState } from "react";
import type { Schemas } from "../../api/client";
import type { Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { optionsOf } from "../../lib/choices";
import { fixed } from "../../lib/format";
import { UndoRedo } from "../../lib/history/UndoRedo";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { type Bar, Bars } from "./Bars";
import { ChipPanel } from "./ChipPanel";
import { CurveEditor, type Tool } from "./CurveEditor";
import { FormulaPanel } from "./FormulaPanel";
import { Harmonics } from "./Harmonics";
import { Metrics } from "./Metrics";
import classes from "./Microsteps.module.css";
import { Transfer } from "./Transfer";
import { type Draft, type Formula, SINE } from "./table";
import { useDraft } from "./useDraft";
import { useDesign, useHeld } from "./useTable";
import { Waves } from "./Waves";
import { XyFigure } from "./XyFigure";

type Question = Schemas["MicrostepDesign"];
type Result = Schemas["MicrostepResult"];

/** Round ticks around zero for errors up to `most`. */
export function symmetricScale(most: number): { low: number; high: number; ticks: number[] } {
  const steps = [0.5, 1, 2, 5, 10, 20, 45, 90, 180];
  const high = steps.find((step) => step >= most) ?? 180;
  return { low: -high, high, ticks: [-high, -high / 2, 0, high / 2, high] };
}

/** The table of a TMC428. `choice` stands where no chip decides which table it is. */
export function QuarterEditor({
  device,
  axis,
  choice,
}: {
  device: Device | undefined;
  axis: number;
  choice?: ReactNode;
}) {
  const connected = device?.state === "connected";
  const drafting = useDraft<Draft>(`quarter ${device?.id}`, "Quarter wave", { kind: "formula", formula: SINE });
  const [tool, setTool] = useState<Tool>("drag");
  const [last, setLast] = useState<Formula>(SINE);
  const [view, setView] = useState<number | null>(null);

  const { draft, change, rest } = drafting;
  // a table drawn by hand has no formula: the panel then shows the one that was last
  const formula = draft.kind === "formula" ? draft.formula : last;

  const chip = useHeld(device, 3000);
  const held = chip.data && !("registers" in chip.data) ? chip.data.values : null;

  const microsteps = device?.axes[axis]?.microsteps_per_full_step ?? 64;
  const chipUsrs = Math.min(6, Math.max(0, Math.round(Math.log2(microsteps))));
  const usrs = view ?? chipUsrs;

  const design = useDesign<Question, Result>(
    draft.kind === "values" ? { values: draft.values, usrs } : { ...draft.formula, usrs },
  );
  const before = useDesign<Question, Result>(held === null ? null : { values: held, usrs });
  const values = draft.kind === "values" ? draft.values : (design.result?.values ?? null);
  const result = design.result;
  const old = held === null ? null : (before.result ?? null);

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
      <div className="columns design until-75">
        <div className="column">
          <Card
            title="Quarter wave"
            note={
              <span className="inline gap-4">
                <i className="key-line" /> design <i className="key-line hue-grey ml-4" /> chip{" "}
                <i className="key-line key-dashed hue-grey ml-4" /> sine
              </span>
            }
            actions={
              <>
                <SegmentedControl
                  aria-label="Pointer"
                  value={tool}
                  onChange={(next) => setTool(next as Tool)}
                  data={optionsOf({ drag: "drag a point", draw: "draw freely" })}
                />
                <UndoRedo />
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
              <div className={`${classes.waiting} center dim text-13`}>{design.error ? "" : "designing the table"}</div>
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
          </Card>
          <ChipPanel
            device={device}
            axis={axis}
            held={held}
            values={values}
            stale={draft.kind === "formula" && design.stale}
            onRead={() => held && change({ kind: "values", values: [...held], origin: "chip" }, null)}
          />
          <Card
            title="In and out"
            actions={
              <Transfer
                values={values}
                onPaste={(next) => change({ kind: "values", values: next, origin: "pasted" }, null)}
              />
            }
          >
            <p className={`num hint m-0 breaks ${draft.kind === "formula" ? stale : ""}`}>
              {values?.map((value) => String(value).padStart(2, "\u2007")).join(" ") ?? " "}
            </p>
          </Card>
        </div>
        <div className="column">
          <Card
            title="Phase currents"
            note="one electrical period, four full steps"
            actions={
              <>
                <span className="hint m-0 mt-4">
                  {usrs === chipUsrs ? "as the chip is set" : "not as the chip is set"}
                </span>
                <Select
                  aria-label="Resolution shown"
                  w={190}
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
            <div className="beside-figure columns gap-12 mid">
              <div className={stale} aria-busy={design.stale}>
                {result ? (
                  <Waves rows={result.sequence} before={old?.sequence ?? null} />
                ) : (
                  <div className={`${classes.waiting} center dim text-13`} />
                )}
              </div>
              <div className={`centered ${stale}`}>
                {result && (
                  <XyFigure rows={result.sequence} before={old?.sequence ?? null} worst={result.metrics.worst_step} />
                )}
                <p className="hint m-0 mt-4">
                  {result?.metrics.worst_step == null
                    ? "current vector"
                    : `orange: the longest step, ${fixed(result.metrics.worst_step_ratio, 2)} × ideal`}
                </p>
              </div>
            </div>
            {result?.warnings.map((warning) => (
              <p key={warning} className="m-0 mt-4 caution text-12">
                {warning}
              </p>
            ))}
          </Card>
          <div className="columns">
            <Card title="Angle error" note="electrical, each microstep">
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
            </Card>
            <Harmonics
              numbers={(result?.metrics.harmonics ?? []).slice(1).map((_, index) => index + 2)}
              design={result?.metrics.harmonics}
              before={old?.metrics.harmonics}
              stale={design.stale}
              height={150}
            />
          </div>
          <Card title="Before and after" note={`at ${2 ** usrs} microsteps per full step`}>
            <div className={stale}>
              {result ? <Metrics before={old?.metrics ?? null} after={result.metrics} /> : null}
            </div>
          </Card>
        </div>
      </div>
    </Page>
  );
}
