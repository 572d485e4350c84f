import { Button, Switch } from "@mantine/core";
import { IconPlayerStop, IconRotateClockwise2 } from "@tabler/icons-react";
import { useState } from "react";
import { Card } from "../../lib/Card";
import { duration } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { durationOf, withRamps } from "../module/HeldRun";
import { RunNote } from "../module/RunNote";
import type { useHeldRun } from "../module/useHeldRun";
import { turnLegs } from "./turns";

interface Props {
  run: ReturnType<typeof useHeldRun>;
  microstepsPerTurn: number;
  fullStepsPerTurn: number;
  /** null while unknown */
  accelerationPps2: number | null;
  /** of the samples */
  rateHz: number;
  disabled: boolean;
}

/** Turns the motor slowly, so that samples come from every angle. */
export function SlowTurn({ run, microstepsPerTurn, fullStepsPerTurn, accelerationPps2, rateHz, disabled }: Props) {
  const [rpm, setRpm] = useState(6);
  const [turns, setTurns] = useState(1);
  const [back, setBack] = useState(true);
  const legs = withRamps(turnLegs({ rpm, turns, back }, microstepsPerTurn, rateHz, fullStepsPerTurn), accelerationPps2);
  return (
    <Card title="Slow turn" note={`takes ${duration(Math.round(durationOf(legs)))}`}>
      <div className="halves gap-8">
        <NumberField
          label="Speed"
          unit="rpm"
          value={rpm}
          min={0.1}
          max={120}
          step={1}
          disabled={disabled || run.running}
          onChange={setRpm}
        />
        <NumberField
          label="Turns"
          value={turns}
          min={0.1}
          max={100}
          step={1}
          disabled={disabled || run.running}
          onChange={setTurns}
        />
      </div>
      <div className="my-8 row between gap-8">
        <Switch
          size="sm"
          label="and back"
          checked={back}
          disabled={disabled || run.running}
          onChange={(event) => setBack(event.currentTarget.checked)}
        />
        {run.running ? (
          <Button
            color="red"
            leftSection={<IconPlayerStop size={16} aria-hidden />}
            onClick={run.abort}
            data-testid="slow-turn"
          >
            Stop
          </Button>
        ) : (
          <Button
            leftSection={<IconRotateClockwise2 size={16} aria-hidden />}
            disabled={disabled}
            onClick={() => run.start(legs)}
            data-testid="slow-turn"
          >
            Turn
          </Button>
        )}
      </div>
      <RunNote
        state={run.state}
        idle="Turns the shaft that far, forward first. Check that nothing is in its way. Escape stops everything."
      />
    </Card>
  );
}
