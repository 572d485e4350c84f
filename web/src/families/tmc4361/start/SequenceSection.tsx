import { Button, Checkbox, Select, Text } from "@mantine/core";
import { useState } from "react";
import { api } from "../../../api/client";
import { Card } from "../../../lib/Card";
import { compact, duration, fixed } from "../../../lib/format";
import { Loading } from "../../../lib/Loading";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import { keyOf } from "../../../lib/rows/staging";
import type { ChipRows } from "../../../lib/rows/useChipRows";
import { useCalc } from "../../../lib/useCalc";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { heldRamp } from "../output/scales";
import { KIND, showingDistance } from "../sramp/design";
import {
  type Entered,
  LONGEST_CLOCKS,
  mostTargets,
  type Option,
  obstacle,
  questionOf,
  SETS,
  type SequenceAnswer,
  type SequenceQuestion,
  type Shadow,
  shadowOf,
  type Trigger,
} from "./sequence";
import classes from "./start.module.css";

const PLACE = 2 ** 31;
const UNITS = { position: "µsteps", velocity: "pps", acceleration: "pps²", jerk: "pps³" } as const;
const HIGHEST = { position: 2 ** 31, velocity: 2 ** 23, acceleration: 1e9, jerk: 1e12 } as const;
const TRIGGERS = [
  { value: "target", label: "TARGET_REACHED, after START_DELAY" },
  { value: "start", label: "a pulse at START" },
];
const OPTIONS = [
  { value: "", label: "none" },
  { value: "0", label: "0: one set, all registers" },
  { value: "1", label: "1: two sets, S-ramp" },
  { value: "2", label: "2: two sets, trapezoid with VSTART" },
  { value: "3", label: "3: two sets, trapezoid with VSTOP" },
];
const ask = (body: SequenceQuestion, signal: AbortSignal): Promise<SequenceAnswer> =>
  api.POST("/api/v1/calc/target-sequence", { body, signal });

interface Props {
  chip: ChipRows;
  clockHz: number;
  disabled: boolean;
}

/** Targets one after the other by pipeline and shadow registers: entered, previewed as a whole, and staged. */
export function SequenceSection({ chip, clockHz, disabled }: Props) {
  const held = heldRamp(chip, clockHz);
  const [entered, setEntered] = useState<Omit<Entered, "targets">>({
    trigger: "target",
    delayS: 0.1,
    everyS: 1,
    ring: false,
    shadow: null,
  });
  const [rows, setRows] = useState<readonly number[] | null>(null);
  const way = held === null ? 1000 : showingDistance(held.design);
  const targets = rows ?? [way, -way, 0];
  const position = chip.held("XACTUAL") ?? 0;
  const question = questionOf(chip, { ...entered, targets }, clockHz, position);
  const { result, stale, error, retry } = useCalc("target-sequence", question, ask);
  const change = (part: Partial<Entered>) => setEntered((now) => ({ ...now, ...part }));
  const most = mostTargets(entered.trigger);
  const blocked = obstacle(chip);
  function stage() {
    if (!result) return;
    const last = chip.spot("XTARGET");
    if (last) chip.discard(keyOf(last.row)); // what sets it going is written last
    for (const { name, value } of result.words) chip.put(name, undefined, value);
  }
  return (
    <Card
      title="Sequence of targets"
      note="the chip makes it alone"
      actions={
        <Button
          onClick={stage}
          disabled={disabled || blocked !== null || !result || stale}
          data-testid="stage-sequence"
        >
          Stage the registers
        </Button>
      }
    >
      {held === null ? (
        <Text className="hint">The chip holds no ramp: set one on the page S-ramp first.</Text>
      ) : (
        <div className="columns until-75">
          <div className="grid gap-8">
            <Targets rows={targets} most={most} onRows={setRows} />
            <div className="halves start gap-8">
              <Select
                label="A start comes from"
                data={TRIGGERS}
                value={entered.trigger}
                onChange={(value) => {
                  const trigger = (value ?? "target") as Trigger;
                  change({ trigger });
                  setRows(targets.slice(0, mostTargets(trigger)));
                }}
                data-testid="sequence-trigger"
              />
              <NumberField
                label="START_DELAY"
                unit="s"
                min={0}
                max={LONGEST_CLOCKS / clockHz}
                step={0.01}
                value={entered.delayS}
                onChange={(delayS) => change({ delayS })}
              />
              {entered.trigger === "start" && (
                <NumberField
                  label="Pulses of the preview every"
                  unit="s"
                  min={1e-4}
                  max={100}
                  step={0.1}
                  value={entered.everyS}
                  onChange={(everyS) => change({ everyS })}
                />
              )}
              <Select
                label="Shadow registers"
                data={OPTIONS}
                value={entered.shadow === null ? "" : String(entered.shadow.option)}
                onChange={(value) => change({ shadow: value ? shadowOf(Number(value) as Option, held.design) : null })}
                data-testid="sequence-shadow"
              />
            </div>
            <Checkbox
              label="it goes round for ever"
              classNames={{ label: "text-12" }}
              checked={entered.ring}
              onChange={(event) => change({ ring: event.currentTarget.checked })}
              data-testid="sequence-ring"
            />
            {entered.shadow && <ShadowFields shadow={entered.shadow} onShadow={(shadow) => change({ shadow })} />}
          </div>
          <div className="grid gap-8">
            {blocked !== null && (
              <Text className="caution text-12" role="status">
                {blocked}
              </Text>
            )}
            {error !== null && <ProblemAlert error={error} doing="Foreseeing the sequence" retry={retry} />}
            {result ? (
              <Preview result={result} stale={stale} />
            ) : (
              error === null && <Loading size="xs" label="Foreseeing the sequence" />
            )}
            <Text className="hint">
              {entered.trigger === "target"
                ? "It begins as soon as XTARGET is applied, which is staged last."
                : "It begins with the first pulse at START."}
            </Text>
          </div>
        </div>
      )}
    </Card>
  );
}

interface TargetsProps {
  rows: readonly number[];
  most: number;
  onRows: (rows: readonly number[]) => void;
}

function Targets({ rows, most, onRows }: TargetsProps) {
  return (
    <fieldset className="plain">
      <legend className="text-12 bold">Targets</legend>
      <ol className="list grid gap-6">
        {rows.map((target, n) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: a row is its place in the sequence
          <li key={n} className="row gap-6">
            <NumberField
              aria-label={`Target ${n + 1}`}
              unit="µsteps"
              integer
              w={160}
              min={-PLACE}
              max={PLACE - 1}
              step={100}
              value={target}
              onChange={(value) => onRows(rows.map((old, place) => (place === n ? value : old)))}
              data-testid={`target-${n + 1}`}
            />
            <Button
              size="compact-xs"
              variant="subtle"
              aria-label={`Remove target ${n + 1}`}
              disabled={rows.length === 1}
              onClick={() => onRows(rows.filter((_, place) => place !== n))}
            >
              Remove
            </Button>
          </li>
        ))}
      </ol>
      <Button
        size="compact-xs"
        variant="default"
        mt={6}
        disabled={rows.length >= most}
        onClick={() => onRows([...rows, 0])}
        data-testid="add-target"
      >
        Add a target
      </Button>{" "}
      <span className="hint">
        {rows.length} of {most}
      </span>
    </fieldset>
  );
}

function ShadowFields({ shadow, onShadow }: { shadow: Shadow; onShadow: (shadow: Shadow) => void }) {
  const put = (place: number, name: string, value: number) =>
    onShadow({ ...shadow, sets: shadow.sets.map((set, n) => (n === place ? { ...set, [name]: value } : set)) });
  return (
    <>
      {shadow.sets.map((set, place) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: a set is its place in the registers
        <fieldset key={place} className="plain">
          <legend className="text-12 bold">{place === 0 ? "The next start takes over" : "The one after it"}</legend>
          <div className="halves start gap-8">
            {SETS[shadow.option].map((name) => (
              <NumberField
                key={name}
                label={name.toUpperCase()}
                unit={UNITS[KIND[name]]}
                min={0}
                max={HIGHEST[KIND[name]]}
                step={1000}
                value={set[name] ?? null}
                onChange={(value) => put(place, name, value)}
                data-testid={`shadow-${place + 1}-${name}`}
              />
            ))}
          </div>
        </fieldset>
      ))}
      <Checkbox
        label="replaced values come back (cyclic_shadow_regs)"
        classNames={{ label: "text-12" }}
        checked={shadow.cyclic}
        onChange={(event) => onShadow({ ...shadow, cyclic: event.currentTarget.checked })}
      />
      <NumberField
        label="starts to let pass between (shadow_miss_cnt)"
        integer
        min={0}
        max={15}
        value={shadow.misses}
        onChange={(misses) => onShadow({ ...shadow, misses })}
      />
    </>
  );
}

function Preview({ result, stale }: { result: SequenceAnswer; stale: boolean }) {
  const scheme = useScheme();
  const marks = result.moves.map((move, n) => ({
    id: `start-${n}`,
    x: move.start_s,
    color: colorOf("position_reached", scheme),
    label: String(n + 1),
    fixed: true,
  }));
  const whole = `${result.moves.length} moves in ${duration(result.duration_s)}${result.ends ? "" : ", and on"}`;
  return (
    <div className="fades" data-stale={stale} aria-busy={stale}>
      <Text size="sm" data-testid="sequence-whole">
        {whole}
      </Text>
      {result.time_s.length > 0 && (
        <>
          <Plot
            label="Position over the sequence"
            summary={whole}
            series={[{ label: "position", unit: "µsteps", color: colorOf("position", scheme), width: 2 }]}
            data={[result.time_s, result.position]}
            x={{ unit: "s" }}
            scales={{ y: { unit: "µsteps" } }}
            marks={marks}
            group="sequence"
            height={190}
          />
          <Plot
            label="Velocity over the sequence"
            series={[{ label: "velocity", unit: "pps", color: colorOf("velocity", scheme), width: 2 }]}
            data={[result.time_s, result.velocity_pps]}
            x={{ unit: "s" }}
            scales={{ y: { unit: "pps", include: [0] } }}
            marks={marks}
            group="sequence"
            height={150}
          />
        </>
      )}
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: on a narrow window the keys scroll it */}
      <section className={classes.frame} tabIndex={0} aria-label="Moves of the sequence">
        <table className="figures" data-testid="sequence-moves">
          <thead>
            <tr>
              <th scope="col">Move</th>
              <th scope="col">Target</th>
              <th scope="col">Start</th>
              <th scope="col">There</th>
              <th scope="col">VMAX</th>
            </tr>
          </thead>
          <tbody>
            {result.moves.map((move, n) => (
              <tr key={move.start_s}>
                <th scope="row">{n + 1}</th>
                <td className="num">{fixed(move.target)}</td>
                <td className="num">{duration(move.start_s)}</td>
                <td className="num">{move.reached ? duration(move.end_s) : "sent elsewhere"}</td>
                <td className="num">{compact(move.vmax_pps, 4, "pps")}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </section>
      {result.findings.map((finding) => (
        <Text key={finding} className="caution text-12" role="status">
          {finding.charAt(0).toUpperCase() + finding.slice(1)}.
        </Text>
      ))}
    </div>
  );
}
