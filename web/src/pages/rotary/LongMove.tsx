import { Button, SegmentedControl, Select } from "@mantine/core";
import { IconPlayerPlayFilled } from "@tabler/icons-react";
import { useState } from "react";
import { Card } from "../../lib/Card";
import { optionsOf } from "../../lib/choices";
import { compact } from "../../lib/format";
import { ExactField } from "./ExactField";
import { abs, grouped, LEAST, MOST, type Ratio, ratio, rounded, times } from "./exact";
import { longTime, pieceCount } from "./pieces";
import { degreesOf, type Turn } from "./turn";

interface Props {
  actual: bigint | null;
  turn: Turn | null;
  pieceLength: bigint;
  /** what it goes at when it is up to speed; null while unknown */
  pps: number | null;
  disabled: boolean;
  going: boolean;
  onGo: (target: bigint) => void;
}

type Unit = "microsteps" | "turns" | "degrees";
const RANGE = "beyond 64 bits: −2^63 to 2^63 − 1 microsteps";

/** A move to any of 2^64 positions. */
export function LongMove({ actual, turn, pieceLength, pps, disabled, going, onGo }: Props) {
  const [value, setValue] = useState<Ratio | null>(null);
  const [text, setText] = useState("");
  const [wrong, setWrong] = useState(false);
  const [unit, setUnit] = useState<Unit>("microsteps");
  const [relative, setRelative] = useState<"to" | "by">("to");
  const shown = turn === null ? "microsteps" : unit;

  const steps = (of: Ratio): bigint => {
    if (shown === "microsteps" || turn === null) return rounded(of);
    const inTurns = shown === "turns" ? of : times(of, ratio(1n, 360n));
    return rounded(times(inTurns, turn.length));
  };
  const targetOf = (of: Ratio): bigint | null => {
    if (relative === "by") return actual === null ? null : actual + steps(of);
    return steps(of) + (shown === "microsteps" ? 0n : (turn?.zero ?? 0n));
  };
  const target = value === null ? null : targetOf(value);
  const outside = target !== null && (target > MOST || target < LEAST);
  const way = target === null || actual === null ? null : target - actual;

  return (
    <Card title="Long move" note="any of 2^64 positions">
      <div className="flex start gap-6">
        <ExactField
          label={relative === "to" ? "Go to" : "Go by"}
          value={text}
          placeholder="1e12, 2^40, −3.5"
          disabled={disabled}
          check={(candidate) => {
            const there = targetOf(candidate);
            return there !== null && (there > MOST || there < LEAST) ? RANGE : null;
          }}
          onValue={(next, typed) => {
            setValue(next);
            setText(typed);
          }}
          onWrong={setWrong}
          data-testid="long-target"
        />
        <Select
          label="in"
          w={96}
          data={[{ value: "microsteps", label: "µsteps" }, ...(turn === null ? [] : ["turns", "degrees"])]}
          value={shown}
          disabled={disabled}
          onChange={(next) => next && setUnit(next as Unit)}
        />
      </div>
      <SegmentedControl
        mt={6}
        fullWidth
        aria-label="Reference"
        data={optionsOf({ to: "to a position", by: "from here" })}
        value={relative}
        disabled={disabled}
        onChange={(next) => setRelative(next as "to" | "by")}
      />
      <dl className="facts my-4 grid gap-2 text-12 right" data-testid="long-preview">
        <div>
          <dt>target</dt>
          <dd>
            <span className="num" data-testid="long-exact">
              {target === null ? "–" : grouped(target)}
            </span>{" "}
            <span className="hint">µsteps</span>
          </dd>
        </div>
        <div>
          <dt>way</dt>
          <dd>
            <span className="num">{way === null || outside ? "–" : grouped(way)}</span>{" "}
            <span className="hint">µsteps</span>
          </dd>
        </div>
        {turn !== null && (
          <div>
            <dt>turns</dt>
            <dd className="num">{way === null || outside ? "–" : compact(degreesOf(way, turn) / 360, 5)}</dd>
          </div>
        )}
        <div>
          <dt>pieces</dt>
          <dd className="num">{way === null || outside ? "–" : compact(pieceCount(way, pieceLength))}</dd>
        </div>
        <div>
          <dt>takes</dt>
          <dd className="num">
            {way === null || outside || pps === null || pps <= 0
              ? "–"
              : `${longTime(Number(abs(way)) / pps)} at ${compact(Math.round(pps), 4, "pps")}`}
          </dd>
        </div>
      </dl>
      <Button
        fullWidth
        leftSection={<IconPlayerPlayFilled size={14} aria-hidden />}
        disabled={disabled || wrong || target === null || outside}
        loading={going}
        onClick={() => target !== null && onGo(target)}
        data-testid="go-long"
      >
        Go
      </Button>
    </Card>
  );
}
