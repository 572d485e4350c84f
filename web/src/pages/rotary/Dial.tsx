import { type KeyboardEvent, type PointerEvent, useEffect, useRef } from "react";
import { coordinate, fixed } from "../../lib/format";
import { colorOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { everyTick } from "../../live/LiveText";
import { useFrame } from "../../live/useFrame";
import { arc, arrow, at, between, FACE, HUB, RIM, wayParts } from "./dial";
import classes from "./rotary.module.css";
import { angleAt, snapped } from "./turn";

export interface Now {
  /** NaN while unknown [deg] */
  angle: number;
  encoder: number;
  /** whole turns as text */
  turns: string;
  /** turns a second, signed; NaN while unknown */
  speed: number;
}

interface Props {
  /** read in every animation frame */
  now: () => Now;
  /** where the staged target lies [deg]; null: none */
  staged: number | null;
  /** how far the hand will go to it, signed and beyond a turn, from the angle where that begins [deg] */
  way: () => { from: number; sweep: number } | null;
  /** where the axis was sent to [deg]; null: nowhere, or it is there */
  sent: number | null;
  disabled: boolean;
  stale: boolean;
  onStage: (angleDeg: number) => void;
  /** the hand was let go after a drag, or Enter */
  onDone: (key: boolean) => void;
}

const TICKS = Array.from({ length: 180 }, (_, index) => index * 2);
const LABELS = Array.from({ length: 12 }, (_, index) => index * 30);
/** How wide the ring is that turns the hand. */
const GRIP = 76;
/** Half the width of the knob, as an angle on the rim. */
const KNOB_DEG = 4;
/** Above this many turns a second a hand at 60 pictures a second shows nothing but stripes. */
const BLUR_TURNS_PER_S = 6;

/** A turn of the shaft: where it was told to be, where the encoder saw it, and a hand to say where to go. */
export function Dial({ now, staged, way, sent, disabled, stale, onStage, onDone }: Props) {
  const scheme = useScheme();
  const commanded = useRef<SVGGElement>(null);
  const encoder = useRef<SVGGElement>(null);
  const apart = useRef<SVGPathElement>(null);
  const blur = useRef<SVGCircleElement>(null);
  const path = useRef<SVGPathElement>(null);
  const head = useRef<SVGPathElement>(null);
  const more = useRef<SVGCircleElement>(null);
  const angleText = useRef<SVGTextElement>(null);
  const turnsText = useRef<SVGTextElement>(null);
  const dragging = useRef(false);
  const latest = useRef({ now, way });
  latest.current = { now, way };

  useFrame(() => {
    const { angle, encoder: seen, speed } = latest.current.now();
    turn(commanded.current, angle);
    turn(encoder.current, seen);
    const lag = between(angle, seen);
    apart.current?.setAttribute("d", Math.abs(lag) > 0.3 ? arc(angle, lag, 98) : "");
    const fast = Math.abs(speed) > BLUR_TURNS_PER_S;
    if (blur.current) blur.current.style.opacity = fast ? "0.3" : "0";
    if (commanded.current) commanded.current.style.opacity = fast ? "0.35" : "";
    const going = latest.current.way();
    const { turns, rest } = wayParts(going?.sweep ?? 0);
    path.current?.setAttribute("d", going ? arc(going.from, rest, RIM) : "");
    // it ends at the hand's knob, not under it
    const short = Math.sign(rest) * Math.max(0, Math.abs(rest) - KNOB_DEG);
    head.current?.setAttribute("d", going ? arrow(going.from, short, RIM) : "");
    if (more.current) more.current.style.opacity = turns === 0 ? "0" : "1";
  });
  useEffect(
    () =>
      everyTick(() => {
        const { angle, turns } = latest.current.now();
        write(angleText.current, Number.isNaN(angle) ? "–" : `${fixed(angle, 2)}°`);
        write(turnsText.current, turns);
        if (turnsText.current) turnsText.current.style.fontSize = `${Math.min(17, 210 / Math.max(1, turns.length))}px`;
      }),
    [],
  );

  function pick(event: PointerEvent<SVGSVGElement>) {
    const box = event.currentTarget.getBoundingClientRect();
    const scale = 400 / box.width;
    const x = (event.clientX - box.left - box.width / 2) * scale;
    const y = (event.clientY - box.top - box.height / 2) * scale;
    onStage(snapped(angleAt(x, y), event.shiftKey ? 15 : event.altKey ? 0.1 : 1));
  }

  function key(event: KeyboardEvent) {
    if (disabled || event.ctrlKey || event.metaKey) return;
    const from = staged ?? Math.round(latest.current.now().angle || 0);
    const steps: Record<string, number> = {
      ArrowRight: 1,
      ArrowUp: 1,
      ArrowLeft: -1,
      ArrowDown: -1,
      PageUp: 30,
      PageDown: -30,
    };
    const step = steps[event.key];
    if (event.key === "Enter" || event.key === " ") onDone(true);
    else if (event.key === "Home") onStage(0);
    else if (event.key === "End") onStage(180);
    else if (step !== undefined) {
      const size = event.shiftKey && Math.abs(step) === 1 ? 10 * step : event.altKey ? step / 10 : step;
      onStage(Number(coordinate((((from + size) % 360) + 360) % 360, 3)));
    } else return;
    event.preventDefault();
  }

  const position = colorOf("position", scheme);
  const seenColor = colorOf("encoder_position", scheme);
  return (
    <svg
      viewBox="-200 -200 400 400"
      className={`${classes.dial} block w-full touchless`}
      data-stale={stale}
      data-disabled={disabled}
      onPointerDown={(event) => {
        if (disabled || event.button !== 0) return;
        dragging.current = true;
        event.currentTarget.setPointerCapture(event.pointerId);
        event.currentTarget.querySelector<SVGGElement>("[role=slider]")?.focus();
        pick(event);
        event.preventDefault();
      }}
      onPointerMove={(event) => {
        if (dragging.current) pick(event);
      }}
      onPointerUp={() => {
        if (dragging.current) onDone(false);
        dragging.current = false;
      }}
      onPointerCancel={() => {
        dragging.current = false;
      }}
    >
      <title>Dial of one turn of the shaft</title>
      <circle r={FACE} fill="var(--raised)" stroke="var(--line)" />
      {TICKS.map((angle) => {
        const size = angle % 30 === 0 ? 13 : angle % 10 === 0 ? 9 : 5;
        const [x1, y1] = at(angle, 150);
        const [x2, y2] = at(angle, 150 - size);
        return (
          <line
            key={angle}
            x1={x1}
            y1={y1}
            x2={x2}
            y2={y2}
            className={classes.dialTick}
            data-major={angle % 30 === 0}
          />
        );
      })}
      {LABELS.map((angle) => {
        const [x, y] = at(angle, 189);
        return (
          <text key={angle} x={x} y={y + 4} textAnchor="middle" className="tick">
            {angle}
          </text>
        );
      })}
      <circle r={RIM} fill="none" stroke="var(--well)" strokeWidth={14} />
      <circle r={RIM} className={classes.grip} style={{ strokeWidth: GRIP }} />
      <circle
        ref={more}
        r={RIM}
        fill="none"
        stroke="var(--accent)"
        strokeWidth={14}
        strokeOpacity={0.22}
        style={{ opacity: 0 }}
      />
      <path ref={path} fill="none" stroke="var(--accent)" strokeWidth={6} strokeOpacity={0.85} />
      <path ref={head} className="fill-accent" />
      {sent !== null && (
        <g transform={`rotate(${sent})`}>
          <path d={`M0 -${RIM - 9}L-7 -${RIM + 9}L7 -${RIM + 9}Z`} fill="var(--slate)" />
        </g>
      )}
      <circle ref={blur} r={122} fill="none" strokeWidth={56} style={{ stroke: position, opacity: 0 }} />
      <path ref={apart} className={classes.apart} style={{ stroke: seenColor }} />
      <g ref={encoder} className={classes.hand} data-testid="encoder-hand" style={{ visibility: "hidden" }}>
        <path d={`M0 -${HUB + 4}V-134`} stroke={seenColor} strokeWidth={2} />
        <circle cy={-140} r={5} fill="none" stroke={seenColor} strokeWidth={2.2} />
      </g>
      <g ref={commanded} className={classes.hand} data-testid="commanded-hand" style={{ visibility: "hidden" }}>
        <path d={`M-8 -${HUB + 5}L-1.6 -148H1.6L8 -${HUB + 5}Z`} fill={position} />
      </g>
      <circle r={HUB} fill="var(--ground)" stroke="var(--line)" />
      <text
        ref={angleText}
        y={2}
        textAnchor="middle"
        className={`${classes.dialAngle} bold mono fill-text`}
        data-testid="dial-angle"
      >
        –
      </text>
      <text
        ref={turnsText}
        y={27}
        textAnchor="middle"
        className={`${classes.dialTurns} text-16 mono fill-text`}
        data-testid="dial-turns"
      />
      <text y={44} textAnchor="middle" className="tick">
        turns
      </text>
      <g
        role="slider"
        tabIndex={disabled ? -1 : 0}
        aria-label="Target angle"
        aria-valuemin={0}
        aria-valuemax={360}
        aria-valuenow={staged ?? sent ?? 0}
        aria-valuetext={staged === null ? "none chosen" : `${fixed(staged, 2)} degrees`}
        aria-disabled={disabled}
        onKeyDown={key}
        transform={`rotate(${staged ?? sent ?? 0})`}
        className={classes.handle}
        data-staged={staged !== null}
      >
        <circle cy={-RIM} r={22} fill="transparent" />
        <path d={`M0 -${HUB + 5}V-${RIM - 12}`} className={classes.handleLine} />
        <circle cy={-RIM} r={11} className={classes.handleKnob} />
        <path d={`M-3.5 -${RIM + 3.5}V-${RIM - 3.5}M0 -${RIM + 3.5}V-${RIM - 3.5}M3.5 -${RIM + 3.5}V-${RIM - 3.5}`} />
      </g>
    </svg>
  );
}

function turn(hand: SVGGElement | null, angle: number) {
  if (!hand) return;
  hand.style.visibility = Number.isNaN(angle) ? "hidden" : "visible";
  if (!Number.isNaN(angle)) hand.setAttribute("transform", `rotate(${coordinate(angle)})`);
}

function write(node: SVGTextElement | null, text: string) {
  if (node && node.textContent !== text) node.textContent = text;
}
