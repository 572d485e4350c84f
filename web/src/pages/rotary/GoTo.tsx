import { Button, Group, SegmentedControl, Switch } from "@mantine/core";
import { IconArrowBackUp, IconPlayerPlayFilled, IconPlayerTrackNext, IconPlayerTrackPrev } from "@tabler/icons-react";
import { useState } from "react";
import { optionsOf } from "../../lib/choices";
import { exactText } from "../../lib/format";
import { LiveText } from "../../live/LiveText";
import { ExactField } from "./ExactField";
import { grouped, type Ratio, toNumber } from "./exact";
import type { Way } from "./turn";

interface Props {
  /** as typed or dragged; null: nothing staged */
  angle: Ratio | null;
  onAngle: (angle: Ratio) => void;
  way: Way;
  onWay: (way: Way) => void;
  /** the way that it will go, and what that is in microsteps; "–" where nothing is staged */
  preview: () => { way: string; steps: string; target: string };
  atOnce: boolean;
  onAtOnce: (on: boolean) => void;
  onGo: () => void;
  onPutBack: () => void;
  turns: bigint;
  onTurns: (turns: bigint) => void;
  onGoTurns: (sign: 1 | -1) => void;
  going: boolean;
  disabled: boolean;
}

const WAY_NAMES = optionsOf({ shortest: "shortest", positive: "+ only", negative: "− only" });
const QUICK = [0, 90, 180, 270];
/** Whole turns at once: what the server takes, too. */
const MOST_TURNS = 1n << 53n;

/** Where the hand is to go, which way, and what that means before anything moves. */
export function GoTo(props: Props) {
  const { angle, onAngle, way, onWay, preview, atOnce, onAtOnce, onGo, onPutBack, turns, onTurns, onGoTurns } = props;
  const { going, disabled } = props;
  const [wrong, setWrong] = useState({ angle: false, turns: false });
  return (
    <div className="grid gap-8">
      <ExactField
        label="Angle"
        unit="°"
        placeholder="drag the hand or type"
        value={angle === null ? "" : exactText(toNumber(angle))}
        disabled={disabled}
        onValue={onAngle}
        onEnter={onGo}
        onWrong={(refused) => setWrong((old) => ({ ...old, angle: refused }))}
        data-testid="target-angle"
      />
      <Group grow gap={4} wrap="nowrap">
        {QUICK.map((quick) => (
          <Button
            key={quick}
            size="compact-xs"
            variant="default"
            disabled={disabled}
            onClick={() => onAngle({ n: BigInt(quick), d: 1n })}
          >
            {quick}°
          </Button>
        ))}
      </Group>
      <SegmentedControl
        fullWidth
        aria-label="Way"
        data={WAY_NAMES}
        value={way}
        disabled={disabled}
        onChange={(value) => onWay(value as Way)}
      />
      <dl className="facts my-4 grid gap-2 text-12 right" data-testid="preview">
        <div>
          <dt>will turn</dt>
          <dd>
            <LiveText read={() => preview().way} className="text-16 bold mono" data-testid="preview-way" />
          </dd>
        </div>
        <div>
          <dt>way</dt>
          <dd>
            <LiveText read={() => preview().steps} data-testid="preview-steps" /> <span className="hint">µsteps</span>
          </dd>
        </div>
        <div>
          <dt>to</dt>
          <dd>
            <LiveText read={() => preview().target} data-testid="preview-target" /> <span className="hint">µsteps</span>
          </dd>
        </div>
      </dl>
      <div className="flex gap-6">
        <Button
          flex={1}
          leftSection={<IconPlayerPlayFilled size={14} aria-hidden />}
          disabled={disabled || wrong.angle || angle === null}
          loading={going}
          onClick={onGo}
          data-testid="go-angle"
        >
          Go
        </Button>
        <Button
          variant="default"
          px={8}
          aria-label="Put the hand back"
          title="Put the hand back"
          disabled={angle === null}
          onClick={onPutBack}
        >
          <IconArrowBackUp size={15} aria-hidden />
        </Button>
      </div>
      <Switch
        label="go when the hand is let go"
        checked={atOnce}
        disabled={disabled}
        onChange={(event) => onAtOnce(event.currentTarget.checked)}
      />
      <div className="flex end gap-6 pt-8 rule-top">
        <ExactField
          label="Whole turns"
          value={grouped(turns)}
          disabled={disabled}
          check={({ n, d }) => (d !== 1n ? "A whole number is needed" : n < 1n || n > MOST_TURNS ? "1 to 2^53" : null)}
          onValue={({ n }) => onTurns(n)}
          onWrong={(refused) => setWrong((old) => ({ ...old, turns: refused }))}
          data-testid="whole-turns"
        />
        <Button
          variant="default"
          px={9}
          aria-label="Turn back by whole turns"
          disabled={disabled || wrong.turns}
          onClick={() => onGoTurns(-1)}
        >
          <IconPlayerTrackPrev size={14} aria-hidden />
        </Button>
        <Button
          variant="default"
          px={9}
          aria-label="Turn forward by whole turns"
          disabled={disabled || wrong.turns}
          onClick={() => onGoTurns(1)}
        >
          <IconPlayerTrackNext size={14} aria-hidden />
        </Button>
      </div>
    </div>
  );
}
