import { Button, Switch } from "@mantine/core";
import { IconPlayerStop, IconStairs } from "@tabler/icons-react";
import { Card } from "../../lib/Card";
import { duration } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { useSessionKept } from "../../lib/useKept";
import { durationOf, sweep, withRamps } from "../module/HeldRun";
import { RunNote } from "../module/RunNote";
import type { useHeldRun } from "../module/useHeldRun";

interface Props {
  run: ReturnType<typeof useHeldRun>;
  microstepsPerTurn: number;
  /** null while unknown: the time at speed is then shorter by the ramps */
  accelerationPps2: number | null;
  disabled: boolean;
}

/** Through several speeds and back, so that the plot over speed fills. */
export function SweepSection({ run, microstepsPerTurn, accelerationPps2, disabled }: Props) {
  const [wanted, setWanted] = useSessionKept("stepscope.stallguard.sweep", {
    from: 15,
    to: 240,
    steps: 10,
    forS: 1,
    bothWays: true,
  });
  const { from, to, steps, forS, bothWays } = wanted;
  const put = (part: Partial<typeof wanted>) => setWanted((old) => ({ ...old, ...part }));
  const locked = disabled || run.running;
  const pps = (rpm: number) => (rpm / 60) * microstepsPerTurn;
  const legs = withRamps(sweep(pps(from), pps(to), steps, forS, bothWays), accelerationPps2);
  return (
    <Card title="Speed sweep" note={`takes ${duration(durationOf(legs))}`}>
      <div className="halves gap-8 mb-8">
        <NumberField
          label="From"
          unit="rpm"
          value={from}
          min={-3000}
          max={3000}
          disabled={locked}
          onChange={(value) => put({ from: value })}
        />
        <NumberField
          label="To"
          unit="rpm"
          value={to}
          min={-3000}
          max={3000}
          disabled={locked}
          onChange={(value) => put({ to: value })}
        />
        <NumberField
          label="Speeds"
          integer
          value={steps}
          min={1}
          max={100}
          disabled={locked}
          onChange={(value) => put({ steps: value })}
        />
        <NumberField
          label="Each for"
          unit="s"
          value={forS}
          min={0.2}
          max={60}
          step={0.5}
          disabled={locked}
          onChange={(value) => put({ forS: value })}
        />
      </div>
      <Switch
        size="sm"
        mb={8}
        label="each speed there and back"
        checked={bothWays}
        disabled={locked}
        onChange={(event) => put({ bothWays: event.currentTarget.checked })}
      />
      {run.running ? (
        <Button
          fullWidth
          color="red"
          leftSection={<IconPlayerStop size={16} aria-hidden />}
          onClick={run.abort}
          data-testid="sweep"
        >
          Stop
        </Button>
      ) : (
        <Button
          fullWidth
          leftSection={<IconStairs size={16} aria-hidden />}
          disabled={disabled}
          onClick={() => run.start(legs)}
          data-testid="sweep"
        >
          Sweep up and back
        </Button>
      )}
      <RunNote
        state={run.state}
        idle={
          bothWays
            ? "A carriage comes back to where it was. Escape stops everything."
            : "The shaft turns on and on in one direction: mind the ends of a stage. Escape stops everything."
        }
      />
    </Card>
  );
}
