import { Button, SegmentedControl, Text } from "@mantine/core";
import { useState } from "react";
import { Card } from "../../lib/Card";
import { optionsOf } from "../../lib/choices";
import { duration } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ExactField, whole } from "./ExactField";
import { grouped, LEAST, MOST, type Ratio, ratio, ratioText, ratioWire, wholeOf } from "./exact";
import type { Change, Extended } from "./extended";
import { GearDrawing } from "./GearDrawing";
import { longTime } from "./pieces";
import { geared } from "./turn";

interface Props {
  seen: Extended;
  /** full steps times microsteps of the motor, as the axis is set now; null while unknown */
  perMotorTurn: number | null;
  /** the shaft's angle now, for the gears [deg] */
  angle: () => number;
  disabled: boolean;
  busy: boolean;
  onChange: (change: Change) => void;
  onForget: () => void;
}

type Kind = "direct" | "gear";
const LONGEST_TURN = 1n << 40n;
const MOST_TEETH = 1_000_000;

/** What a turn of the axis is, where its angle 0 lies, and for how long it may be left alone. */
export function Setup({ seen, perMotorTurn, angle, disabled, busy, onChange, onForget }: Props) {
  const { answer, turn } = seen;
  const gear = answer.rotary?.gear ?? null;
  const [kind, setKind] = useState<Kind>(gear ? "gear" : "direct");
  const [perTurn, setPerTurn] = useState<Ratio>(turn?.length ?? ratio(BigInt(perMotorTurn ?? 51_200)));
  const [motorSteps, setMotorSteps] = useState(gear?.microsteps_per_motor_turn ?? perMotorTurn ?? 51_200);
  const [motorTeeth, setMotorTeeth] = useState(gear?.motor_teeth ?? 3);
  const [drivenTeeth, setDrivenTeeth] = useState(gear?.driven_teeth ?? 7);
  const [actual, setActual] = useState("");

  const planned = kind === "gear" ? geared(BigInt(motorSteps), BigInt(motorTeeth), BigInt(drivenTeeth)) : perTurn;
  const held = turn !== null && turn.length.n === planned.n && turn.length.d === planned.d;
  const bits = answer.counter_bits;
  const send = () =>
    onChange(
      kind === "gear"
        ? {
            gear: {
              microsteps_per_motor_turn: motorSteps,
              motor_teeth: motorTeeth,
              driven_teeth: drivenTeeth,
            },
          }
        : { microsteps_per_turn: ratioWire(perTurn) },
    );
  const zero = wholeOf(answer.rotary?.zero_text);

  return (
    <Card
      title="Set up"
      note={answer.watching ? "watched" : "not watched"}
      actions={
        answer.watching ? (
          <Button
            size="compact-xs"
            variant="default"
            disabled={disabled || answer.state === "moving"}
            onClick={onForget}
            data-testid="forget"
          >
            Stop watching
          </Button>
        ) : undefined
      }
    >
      <SegmentedControl
        fullWidth
        aria-label="What a turn is given by"
        data={optionsOf({ direct: "microsteps", gear: "gear" })}
        value={kind}
        disabled={disabled}
        onChange={(next) => setKind(next as Kind)}
      />
      {kind === "direct" ? (
        <ExactField
          mt={8}
          label="A turn is"
          unit="µsteps"
          value={ratioText(perTurn)}
          disabled={disabled}
          check={({ n, d }) => (n <= 0n ? "More than 0" : n > LONGEST_TURN * d ? "At most 2^40" : null)}
          onValue={setPerTurn}
          description={
            perMotorTurn === null ? undefined : `whole or a fraction; the motor's own turn is ${perMotorTurn}`
          }
          data-testid="per-turn"
        />
      ) : (
        <div className="grid gap-6 mt-8">
          <div className="grid gap-6">
            <NumberField
              label="Motor's turn"
              unit="µsteps"
              integer
              min={1}
              max={2 ** 40}
              value={motorSteps}
              disabled={disabled}
              onChange={setMotorSteps}
              data-testid="motor-steps"
            />
            <div className="halves gap-6">
              <NumberField
                label="Motor's teeth"
                integer
                min={1}
                max={MOST_TEETH}
                value={motorTeeth}
                disabled={disabled}
                onChange={setMotorTeeth}
                data-testid="motor-teeth"
              />
              <NumberField
                label="Shaft's teeth"
                integer
                min={1}
                max={MOST_TEETH}
                value={drivenTeeth}
                disabled={disabled}
                onChange={setDrivenTeeth}
                data-testid="driven-teeth"
              />
            </div>
          </div>
          <GearDrawing motorTeeth={motorTeeth} drivenTeeth={drivenTeeth} angle={angle} />
        </div>
      )}
      <div className="lines-4 baseline mt-8 text-12">
        <Text component="span" size="xs" c="dimmed">
          a turn
        </Text>
        <span className="num" data-testid="turn-length">
          {ratioText(planned, true)}
        </span>
        <Text component="span" size="xs" c="dimmed">
          µsteps
        </Text>
        <Button
          size="compact-xs"
          ml="auto"
          variant={held && answer.watching ? "default" : "filled"}
          disabled={disabled || answer.state === "moving" || (held && answer.watching)}
          loading={busy}
          onClick={send}
          data-testid="watch"
        >
          {answer.watching ? (held ? "is set" : "Set") : "Watch this axis"}
        </Button>
      </div>
      {answer.watching && (
        <>
          <div className="lines-4 baseline mt-8 text-12">
            <Text component="span" size="xs" c="dimmed">
              angle 0 at
            </Text>
            <span className="num" data-testid="zero-at">
              {zero === null ? "–" : grouped(zero)}
            </span>
            <Button
              size="compact-xs"
              ml="auto"
              variant="default"
              disabled={disabled || turn === null || answer.actual_text === null || answer.state === "moving"}
              onClick={() => answer.actual_text !== null && onChange({ zero: answer.actual_text })}
              data-testid="zero-here"
            >
              Zero here
            </Button>
          </div>
          <div className="flex end gap-6 mt-8">
            <ExactField
              label="It stands at"
              unit="µsteps"
              value={actual}
              placeholder={answer.actual_text ?? ""}
              disabled={disabled || answer.state === "moving"}
              check={whole(LEAST, MOST, "−2^63 to 2^63 − 1")}
              onValue={({ n }) => setActual(n.toString())}
              data-testid="set-actual-value"
            />
            <Button
              variant="default"
              disabled={disabled || actual === "" || answer.state === "moving"}
              onClick={() => {
                onChange({ actual });
                setActual("");
              }}
              data-testid="set-actual"
            >
              Set
            </Button>
          </div>
        </>
      )}
      <dl className="facts pairs m-0 mt-8 pt-8 text-12 tight rule-top">
        <dt>counter</dt>
        <dd>{bits === null ? "cannot be followed" : `${bits} bits, then it wraps`}</dd>
        {answer.service_period_s !== null && (
          <>
            <dt>looked at every</dt>
            <dd>{period(answer.service_period_s)}, at the least</dd>
          </>
        )}
        {answer.allowed_s !== null && (
          <>
            <dt>lost after</dt>
            <dd>{period(answer.allowed_s)} unseen</dd>
          </>
        )}
        {answer.rotary && (
          <>
            <dt>a wrap adds</dt>
            <dd>{answer.rotary.displacement_const} µsteps to the place in the turn</dd>
          </>
        )}
      </dl>
    </Card>
  );
}

function period(seconds: number): string {
  return seconds < 60 ? duration(seconds) : longTime(seconds);
}
