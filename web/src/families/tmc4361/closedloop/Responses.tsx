import { ActionIcon, Button, Group, NativeSelect, Progress, SegmentedControl, Text } from "@mantine/core";
import { IconWaveSquare, IconX } from "@tabler/icons-react";
import { useEffect, useMemo, useState } from "react";
import type { AxisAddress } from "../../../api/motion";
import { Card } from "../../../lib/Card";
import { optionsOf } from "../../../lib/choices";
import { EmptyState } from "../../../lib/EmptyState";
import { compact, duration, fixed } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import classes from "./closedloop.module.css";
import { ResponsePlot } from "./ResponsePlot";
import { bestOf, type Kind, type Run, type Score, useRuns, type View } from "./runs";
import { type Responding, useDisturbance, useStepResponse } from "./useProcedures";

interface Props {
  at: AxisAddress;
  connected: boolean;
  emulated: boolean;
  rateMaxHz: number;
  /** what the gains are now, in short */
  settings: string;
}

/** What a step or a load does to the axis: recorded, scored, and drawn over what it did with other gains. */
export function Responses({ at, connected, emulated, rateMaxHz, settings }: Props) {
  const [kind, setKind] = useState<Kind>("step");
  const [view, setView] = useState<View>("position");
  const step = useStepResponse(at, connected);
  const load = useDisturbance(at, connected);
  const { runs, add, forget, clear } = useRuns(`${at.device}/${at.axis}`);
  const responding: Responding = kind === "step" ? step : load;
  const running = step.running || load.running;

  useTaken("step", step.state, settings, add);
  useTaken("load", load.state, settings, add);

  const shown = useMemo(() => runs.filter((run) => run.kind === kind), [runs, kind]);
  const band = shown.at(-1)?.score.band ?? null;
  return (
    <Card
      title="Response"
      note={shown.length > 1 ? "the newest in colour, those before as ghosts" : undefined}
      actions={
        <SegmentedControl
          aria-label="Kind of response"
          data={optionsOf({ step: "Step", load: "Disturbance" })}
          value={kind}
          onChange={(value) => setKind(value as Kind)}
        />
      }
    >
      <div className="lines-8 end">
        {kind === "step" ? (
          <StepForm start={step.start} disabled={!connected || running} rateMaxHz={rateMaxHz} />
        ) : (
          <LoadForm start={load.start} disabled={!connected || running} emulated={emulated} rateMaxHz={rateMaxHz} />
        )}
        <Button variant="default" disabled={!responding.running} onClick={responding.abort}>
          Abort
        </Button>
        <div className={classes.progress}>
          <Progress
            size="sm"
            value={100 * (responding.running ? (responding.state?.progress ?? 0) : 0)}
            aria-label="Progress of the recording"
          />
          <Text
            size="xs"
            c="dimmed"
            role="status"
            data-testid="response-state"
            data-state={responding.state?.state ?? "unknown"}
          >
            {responding.running
              ? `${responding.state?.phase ?? ""}…`
              : responding.state?.state === "failed" || responding.state?.state === "aborted"
                ? responding.state.message
                : "\u00a0"}
          </Text>
        </div>
      </div>
      {responding.error && (
        <ProblemAlert
          error={responding.error}
          doing={kind === "step" ? "Step response" : "Disturbance"}
          onClose={responding.dismiss}
        />
      )}
      {shown.length === 0 ? (
        <EmptyState
          title={kind === "step" ? "No step recorded yet" : "No disturbance recorded yet"}
          icon={<IconWaveSquare size={22} />}
        >
          <Text size="sm" c="dimmed" maw={420}>
            {kind === "step"
              ? "Record one, change a gain, record again: the curves lie over one another, and their scores beside each other."
              : emulated
                ? "The emulated shaft is loaded for a while, and what the axis does about it is recorded."
                : "Start, then load the shaft by hand: what the axis does about it is recorded."}
          </Text>
        </EmptyState>
      ) : (
        <>
          <Group justify="space-between" mt={4} gap="xs">
            <SegmentedControl
              aria-label="What is drawn"
              data={optionsOf({ position: "Position", deviation: "Deviation", velocity: "Speed", angle: "Load angle" })}
              value={view}
              onChange={(value) => setView(value as View)}
            />
            <Button size="compact-xs" variant="subtle" onClick={clear}>
              Forget all
            </Button>
          </Group>
          <ResponsePlot runs={shown} view={view} band={band} />
          <Scores runs={shown} kind={kind} onForget={forget} />
        </>
      )}
    </Card>
  );
}

/** Takes a finished recording into the list of runs, with the settings of that moment. */
function useTaken(
  kind: Kind,
  state: Responding["state"],
  settings: string,
  add: (run: Omit<Run, "number">) => void,
): void {
  useEffect(() => {
    if (state?.state !== "done" || !state.recording || !state.score || state.started_at_s === null) return;
    add({ id: state.started_at_s, kind, recording: state.recording, score: state.score, settings });
  });
}

interface FormProps<Body> {
  start: (body: Body) => void;
  disabled: boolean;
  rateMaxHz: number;
}

function StepForm({
  start,
  disabled,
  rateMaxHz,
}: FormProps<Parameters<ReturnType<typeof useStepResponse>["start"]>[0]>) {
  const [distance, setDistance] = useState(5120);
  const [shape, setShape] = useState<"ramp" | "step">("step");
  const [seconds, setSeconds] = useState(1);
  const [band, setBand] = useState(50);
  return (
    <>
      <NumberField
        label="Distance"
        unit="microsteps"
        integer
        min={-(2 ** 30)}
        max={2 ** 30}
        step={256}
        value={distance}
        onChange={setDistance}
        disabled={disabled}
        w={130}
      />
      <NativeSelect
        label="Command"
        data={optionsOf({ step: "jumps", ramp: "goes on the ramp" })}
        value={shape}
        disabled={disabled}
        onChange={(event) => setShape(event.currentTarget.value as "ramp" | "step")}
        w={132}
      />
      <Seconds value={seconds} onChange={setSeconds} disabled={disabled} />
      <Band value={band} onChange={setBand} disabled={disabled} />
      <Button
        disabled={disabled || distance === 0}
        onClick={() => {
          start({ distance, shape, seconds, band, rate_hz: rateFor(rateMaxHz), before_s: 0.05 });
          setDistance(-distance); // there and back: the axis does not run away
        }}
        data-testid="record-step"
      >
        Record a step
      </Button>
    </>
  );
}

function LoadForm({
  start,
  disabled,
  emulated,
  rateMaxHz,
}: FormProps<Parameters<ReturnType<typeof useDisturbance>["start"]>[0]> & { emulated: boolean }) {
  const [torque, setTorque] = useState(0.1);
  const [loadS, setLoadS] = useState(0.5);
  const [seconds, setSeconds] = useState(1);
  const [band, setBand] = useState(50);
  return (
    <>
      {emulated && (
        <>
          <NumberField
            label="Load torque"
            unit="N·m"
            min={-50}
            max={50}
            step={0.01}
            value={torque}
            onChange={setTorque}
            disabled={disabled}
            w={120}
          />
          <NumberField
            label="for"
            unit="s"
            min={0.05}
            max={30}
            step={0.1}
            value={loadS}
            onChange={setLoadS}
            disabled={disabled}
            w={84}
          />
        </>
      )}
      <Seconds value={seconds} onChange={setSeconds} disabled={disabled} />
      <Band value={band} onChange={setBand} disabled={disabled} />
      <Button
        disabled={disabled}
        onClick={() =>
          start({
            load_torque_nm: emulated ? torque : null,
            load_s: emulated ? loadS : null,
            seconds,
            band,
            rate_hz: rateFor(rateMaxHz),
            before_s: 0.05,
          })
        }
        data-testid="record-load"
      >
        {emulated ? "Load and record" : "Record"}
      </Button>
    </>
  );
}

function rateFor(most: number): number {
  return Math.max(10, Math.min(1000, Math.floor(most)));
}

interface NumberProps {
  value: number;
  onChange: (value: number) => void;
  disabled: boolean;
}

function Seconds({ value, onChange, disabled }: NumberProps) {
  return (
    <NumberField
      label="Record"
      unit="s"
      min={0.05}
      max={30}
      step={0.1}
      value={value}
      onChange={onChange}
      disabled={disabled}
      w={84}
    />
  );
}

function Band({ value, onChange, disabled }: NumberProps) {
  return (
    <NumberField
      label="Settled within"
      unit="microsteps"
      min={0.5}
      max={1e6}
      step={10}
      value={value}
      onChange={onChange}
      disabled={disabled}
      w={120}
    />
  );
}

interface Figure {
  label: string;
  of: (score: Score) => number | null;
  text: (score: Score) => string;
  only?: Kind;
}

const FIGURES: readonly Figure[] = [
  {
    label: "Overshoot",
    of: (score) => score.overshoot,
    text: (score) =>
      `${fixed(score.overshoot, 1)}${score.overshoot_ratio === null ? "" : ` (${fixed(100 * score.overshoot_ratio, 2, "%")})`}`,
  },
  {
    label: "Settling",
    of: (score) => score.settling_s,
    text: (score) => (score.settling_s === null ? "never" : duration(score.settling_s)),
  },
  {
    label: "Arrival",
    only: "step",
    of: (score) => score.arrival_s,
    text: (score) => (score.arrival_s === null ? "never" : duration(score.arrival_s)),
  },
  { label: "RMS", of: (score) => score.rms, text: (score) => fixed(score.rms, 2) },
  { label: "Peak", of: (score) => score.peak, text: (score) => fixed(score.peak, 1) },
  { label: "IAE", of: (score) => score.iae, text: (score) => compact(score.iae) },
  { label: "At the end", of: (score) => score.final_error, text: (score) => fixed(score.final_error, 1) },
];

/** Scores beside each other, the newest first; the best of a column stands out. */
function Scores({ runs, kind, onForget }: { runs: readonly Run[]; kind: Kind; onForget: (id: number) => void }) {
  const figures = FIGURES.filter((figure) => figure.only === undefined || figure.only === kind);
  const best = figures.map((figure) => bestOf(runs, figure.of));
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: a table that scrolls has to be reached with the keys
    <section className="scroll-x nowrap" tabIndex={0} aria-label="Scores">
      <table className="figures" data-testid="scores">
        <thead>
          <tr>
            <th scope="col">Run</th>
            {figures.map((figure) => (
              <th key={figure.label} scope="col">
                {figure.label}
              </th>
            ))}
            <td />
          </tr>
        </thead>
        <tbody>
          {[...runs].reverse().map((run, index) => (
            <tr key={run.id} data-run={run.number}>
              <th scope="row">
                <span className={classes.runSwatch} data-ghost={index} aria-hidden />#{run.number}{" "}
                <span className="dim regular">{run.settings}</span>
              </th>
              {figures.map((figure, column) => (
                <td key={figure.label} className="num" data-best={best[column] === run.id} data-figure={figure.label}>
                  {figure.text(run.score)}
                </td>
              ))}
              <td>
                <ActionIcon size={20} aria-label={`Forget run ${run.number}`} onClick={() => onForget(run.id)}>
                  <IconX size={13} />
                </ActionIcon>
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      <Text size="xs" c="dimmed" mt={4}>
        Curves are drawn in the direction of the step. Distances in microsteps, of the encoder; RMS, peak and IAE
        [µsteps·s] of its deviation from the command.
      </Text>
    </section>
  );
}
