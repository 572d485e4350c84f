import { Text, UnstyledButton } from "@mantine/core";
import { useClipboard, useLocalStorage } from "@mantine/hooks";
import { useMutation } from "@tanstack/react-query";
import { useEffect, useRef, useState } from "react";
import { motion } from "../../api/motion";
import { can, type Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { colorOf } from "../../lib/palette";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { scaleOf } from "../../lib/units";
import { useScheme } from "../../lib/useScheme";
import { WarningLines } from "../../lib/Warnings";
import { LiveText } from "../../live/LiveText";
import { useTelemetry } from "../../live/useTelemetry";
import { useTopSpeed } from "../bench/motion/useMotionLimits";
import { LiveNumber } from "../module/LiveNumber";
import { CompareAndLatch } from "./CompareAndLatch";
import { Dial, type Now } from "./Dial";
import { wayText } from "./dial";
import { abs, fromNumber, grouped, type Ratio, toNumber } from "./exact";
import { type Change, type Extended, liveActual, liveEncoder } from "./extended";
import { GoTo } from "./GoTo";
import { HistoryPlot } from "./HistoryPlot";
import { LongMove } from "./LongMove";
import { PiecesBar } from "./PiecesBar";
import { Pace, viewOf } from "./pieces";
import classes from "./rotary.module.css";
import { Setup } from "./Setup";
import { Trust } from "./Trust";
import { degreesOf, placeOf, type Turn, targetAt, type Way } from "./turn";
import type { ExtendedAxis } from "./useExtended";

const RATE_HZ = 60;
const KEEP_S = 65;

interface Props {
  device: Device;
  axis: Device["axes"][number];
  extended: ExtendedAxis;
  seen: Extended;
  connected: boolean;
}

/** One axis as a dial, with all of its position. */
export function RotaryAxis({ device, axis, extended, seen, connected }: Props) {
  const scheme = useScheme();
  const at = { device: device.id, axis: axis.index };
  const { answer, turn } = seen;
  const channels = ["position", "velocity", "encoder_position"]
    .map((quantity) => `${quantity}.${axis.index}`)
    .filter((name) => device.channels.some((channel) => channel.name === name));
  const { source, link, buffer } = useTelemetry(device.id, channels, Math.min(RATE_HZ, device.rate_max_hz), KEEP_S);
  const top = useTopSpeed(at, device, scaleOf(axis, device.clock_hz), connected);

  const [staged, setStagedState] = useState<Ratio | null>(null);
  const [way, setWay] = useLocalStorage<Way>({ key: "stepscope.rotary.way", defaultValue: "shortest" });
  const [atOnce, setAtOnce] = useLocalStorage({ key: "stepscope.rotary.at-once", defaultValue: false });
  const [turns, setTurns] = useState(1n);
  const [failed, setFailed] = useState<{ doing: string; error: unknown } | null>(null);
  const stop = useMutation({ mutationFn: () => motion.stop(at, "ramp") });

  const latest = useRef({ seen, staged, way });
  latest.current = { seen, staged, way };
  // known at once, not after the next rendering: Enter in the field and a hand let go send what was entered with them
  const setStaged = (angle: Ratio | null) => {
    latest.current.staged = angle;
    setStagedState(angle);
  };
  /** the target that stands on the page, and the entry that it is of */
  const drawn = useRef<{ staged: Ratio; way: Way; turn: Turn; target: bigint } | null>(null);
  const fresh = connected && link.phase === "live";
  const count = (quantity: string) => (fresh ? buffer.last(`${quantity}.${axis.index}`) : Number.NaN);
  const actualNow = () => liveActual(latest.current.seen, count("position"));
  const encoderNow = () => liveEncoder(latest.current.seen, count("position"), count("encoder_position"));

  const [pace] = useState(() => new Pace());
  // biome-ignore lint/correctness/useExhaustiveDependencies: another target is another move, with a pace of its own
  useEffect(() => pace.clear(), [pace, answer.target_text]);
  useEffect(() => {
    if (seen.actual !== null && answer.last_look_s !== null) pace.add(answer.last_look_s, seen.actual);
  }, [pace, seen, answer.last_look_s]);

  const change = async (doing: string, body: Change) => {
    setFailed(null);
    try {
      await extended.change.mutateAsync(body);
      return true;
    } catch (error) {
      setFailed({ doing, error });
      return false;
    }
  };
  const usable = connected && answer.watching && answer.trusted && answer.state !== "lost";
  const going = extended.change.isPending;
  const go = (angle: Ratio | null) => {
    if (angle === null || !usable) return;
    // What is shown is what is sent: the target itself, not the angle, whose nearest place may be another one meanwhile.
    const { staged: of, way: by, turn: turned } = drawn.current ?? {};
    const shown = of === angle && by === latest.current.way && turned === latest.current.seen.turn;
    const target = shown ? drawn.current?.target : staging()?.target;
    if (target === undefined) return;
    void change("Turning to the angle", { target: target.toString() }).then((sent) => {
      if (sent && latest.current.staged === angle) setStaged(null);
    });
  };

  const now = (): Now => {
    const actual = actualNow();
    const of = latest.current.seen.turn;
    if (actual === null || of === null)
      return { angle: Number.NaN, encoder: Number.NaN, turns: "–", speed: Number.NaN };
    const place = placeOf(actual, of);
    const encoder = encoderNow();
    return {
      angle: place.angleDeg,
      encoder: encoder === null ? Number.NaN : placeOf(encoder, of).angleDeg,
      turns: grouped(place.turns),
      speed: count("velocity") / toNumber(of.length),
    };
  };
  const staging = (): { from: number; steps: bigint; target: bigint } | null => {
    const { seen: known, staged: angle, way: chosen } = latest.current;
    const actual = actualNow();
    if (actual === null || known.turn === null || angle === null) return null;
    const target = targetAt(actual, known.turn, angle, chosen);
    return { from: placeOf(actual, known.turn).angleDeg, steps: target - actual, target };
  };
  /** of what is staged, else of the move under way */
  const wayNow = () => {
    const preview = staging();
    const { turn: of, target, answer: told } = latest.current.seen;
    if (of === null) return null;
    if (preview) return { from: preview.from, sweep: degreesOf(preview.steps, of) };
    const actual = actualNow();
    if (told.state !== "moving" || actual === null || target === null) return null;
    return { from: placeOf(actual, of).angleDeg, sweep: degreesOf(target - actual, of) };
  };
  const preview = () => {
    const next = staging();
    const of = latest.current.seen.turn;
    const { staged: entry, way: by } = latest.current;
    drawn.current = next && entry && of && { staged: entry, way: by, turn: of, target: next.target };
    if (next === null || of === null) return { way: "–", steps: "–", target: "–" };
    return { way: wayText(degreesOf(next.steps, of)), steps: grouped(next.steps), target: grouped(next.target) };
  };

  const moving = answer.state === "moving";
  const left = seen.actual === null || seen.target === null ? 0n : seen.target - seen.actual;
  const view =
    moving && seen.start !== null && seen.target !== null && seen.actual !== null
      ? viewOf(seen.start, seen.target, seen.actual, seen.pieceLength)
      : null;
  const sent = turn !== null && moving && seen.target !== null ? placeOf(seen.target, turn).angleDeg : null;

  const setup = (
    <Setup
      key={`turn ${answer.rotary?.microsteps_per_turn ?? "none"}`}
      seen={seen}
      perMotorTurn={
        axis.microsteps_per_full_step === null ? null : axis.full_steps_per_rev * axis.microsteps_per_full_step
      }
      angle={() => now().angle}
      disabled={!connected || answer.counter_bits === null}
      busy={going}
      onChange={(body) => void change("Setting up", body)}
      onForget={() => extended.forget.mutate()}
    />
  );
  const longMove = (
    <LongMove
      key="long move"
      actual={seen.actual}
      turn={turn}
      pieceLength={seen.pieceLength}
      pps={top}
      disabled={!usable}
      going={going}
      onGo={(target) => void change("Starting the move", { target: target.toString() })}
    />
  );

  return (
    <Page name="Rotary">
      <DeviceNotice device={device} />
      {failed && <ProblemAlert {...failed} onClose={() => setFailed(null)} />}
      {stop.isError && <ProblemAlert error={stop.error} doing="Stopping" onClose={stop.reset} />}
      {extended.query.isError && connected && <ProblemAlert error={extended.query.error} doing="Looking" />}
      <Trust seen={seen} disabled={!connected} busy={going} onChange={(body) => void change("Setting it", body)} />
      <WarningLines texts={answer.warnings} />
      <Card
        className={`pad lines-24 start ${!connected || !answer.watching || !answer.trusted ? "dim" : ""}`}
        aria-label="Now"
        data-stale={!connected || !answer.watching || !answer.trusted}
      >
        <Exact label="Actual" read={actualNow} color={colorOf("position", scheme)} testId="actual" />
        <Exact label="Target" read={() => seen.target} color={colorOf("target_position", scheme)} testId="target" />
        {seen.encoder !== null && (
          <LiveNumber
            label="Encoder"
            unit="°"
            read={() => fixed(now().encoder, 2)}
            color={colorOf("encoder_position", scheme)}
            testId="encoder-angle"
          />
        )}
        <LiveNumber
          label="Speed"
          unit="rpm"
          read={() => fixed(now().speed * 60, 1)}
          color={colorOf("velocity", scheme)}
        />
        <LiveNumber
          label="Counter"
          unit="µsteps"
          read={() => fixed(Number.isNaN(count("position")) ? answer.counter : count("position"))}
          testId="counter"
        />
        <div className={classes.state}>
          <span
            className={`text-13 bold tight ${answer.watching ? (STATE_LOOKS[answer.state] ?? "") : ""}`}
            data-testid="state"
          >
            {STATES[answer.state]}
          </span>
          <Text size="xs" c="dimmed" lineClamp={2}>
            {answer.message}
          </Text>
        </div>
      </Card>
      <div className="columns side-right until-75">
        <div className="column">
          <Card title="Dial" note={turn ? <DialLegend encoder={answer.encoder_position_text !== null} /> : undefined}>
            {turn === null && (
              <Text className="hint" role="status">
                {answer.watching
                  ? "This axis has no turn yet: say under Set up how many microsteps it is."
                  : "Nobody watches this axis yet. Say under Set up what a turn is, then watch it: from then on the server keeps its turns, beyond the counter and over restarts."}
              </Text>
            )}
            <div className={`${classes.dialBox} columns gap-16 mid`}>
              <Dial
                now={now}
                staged={staged === null ? null : toNumber(staged)}
                way={wayNow}
                sent={sent}
                stale={!usable || turn === null}
                disabled={!usable || turn === null}
                onStage={(angle) => setStaged(fromNumber(angle))}
                onDone={(key) => (key || atOnce) && go(latest.current.staged)}
              />
              <GoTo
                angle={staged}
                onAngle={setStaged}
                way={way}
                onWay={setWay}
                preview={preview}
                atOnce={atOnce}
                onAtOnce={setAtOnce}
                onGo={() => go(latest.current.staged)}
                onPutBack={() => setStaged(null)}
                turns={turns}
                onTurns={setTurns}
                onGoTurns={(sign) => void change("Turning by whole turns", { turns: Number(turns) * sign })}
                going={going}
                disabled={!usable || turn === null}
              />
            </div>
          </Card>

          <PiecesBar
            view={view}
            length={seen.pieceLength}
            left={abs(left)}
            leftTurns={turn === null ? null : degreesOf(abs(left), turn) / 360}
            timeLeftS={seen.target === null || seen.actual === null ? null : pace.timeTo(seen.target, seen.actual)}
            pps={pace.pps}
            moving={moving}
            stopping={stop.isPending}
            onStop={() => stop.mutate()}
            disabled={!connected}
          />
          <HistoryPlot at={at} source={source} seen={seen} connected={connected} />
        </div>
        <div className="column controls">
          {answer.watching ? [longMove, setup] : [setup, longMove]}
          <CompareAndLatch
            key={`${at.device} ${at.axis}`}
            device={device}
            at={at}
            seen={seen}
            compares={can(device, "position_compare")}
            disabled={!usable}
            busy={going}
            onChange={(body) => void change("Setting what is compared", body)}
          />
        </div>
      </div>
    </Page>
  );
}

const STATES: Record<Extended["answer"]["state"], string> = {
  off: "not watched",
  idle: "stands",
  moving: "on its way",
  lost: "lost",
};

const STATE_LOOKS: Partial<Record<Extended["answer"]["state"], string>> = { moving: "accent", lost: "fault" };

/** A position with all of its digits; a click copies them plain. */
function Exact(props: { label: string; read: () => bigint | null; color: string; testId: string }) {
  const { label, read, color, testId } = props;
  const clipboard = useClipboard({ timeout: 1500 });
  return (
    <div className={classes.exact}>
      <Text size="xs" c="dimmed" className="row gap-4 tight">
        <span className="swatch inline-block" style={{ background: color }} />
        {label} µsteps
        {clipboard.copied && <span className="good">copied</span>}
      </Text>
      <UnstyledButton
        className="figure-20 anywhere"
        aria-label={`Copy ${label.toLowerCase()}`}
        title="Copy all digits"
        onClick={() => {
          const value = read();
          if (value !== null) clipboard.copy(value.toString());
        }}
      >
        <LiveText
          read={() => {
            const value = read();
            return value === null ? "–" : grouped(value);
          }}
          data-testid={testId}
        />
      </UnstyledButton>
    </div>
  );
}

function DialLegend({ encoder }: { encoder: boolean }) {
  const scheme = useScheme();
  return (
    <span className="inline wrap gap-4">
      <span className="swatch inline-block" style={{ background: colorOf("position", scheme) }} /> commanded
      {encoder && (
        <>
          <span className="swatch inline-block" style={{ background: colorOf("encoder_position", scheme) }} /> encoder
        </>
      )}
    </span>
  );
}
