import { type KeyboardEvent, type PointerEvent, useRef, useState } from "react";
import { duration, fixed } from "../../lib/format";
import { useScheme } from "../../lib/useScheme";
import { useFrame } from "../../live/useFrame";
import { isFault, type Lane, nearest } from "./EventLog";
import classes from "./events.module.css";
import type { EventBit } from "./useEvents";

const LANE_PX = 18;
const HIT_PX = 8;

export interface TimeWindow {
  /** what is seen now [s of device time] */
  current: () => readonly [number, number];
  /** where the plots above begin and end, in pixels of the page; null where there are none */
  box: () => { left: number; width: number } | null;
}

interface LanesProps {
  lanes: readonly Lane[];
  bits: readonly EventBit[];
  window: TimeWindow;
  name: string;
}

interface Under {
  lane: number;
  index: number;
  x: number;
}

/** The events in rows, a bit each. */
export function Lanes({ lanes, bits, window, name }: LanesProps) {
  const scheme = useScheme();
  const canvas = useRef<HTMLCanvasElement>(null);
  const drawn = useRef("");
  const [under, setUnder] = useState<Under | null>(null);
  const [spoken, setSpoken] = useState("");
  const height = lanes.length * LANE_PX;

  /** Left edge and width of the time axis in pixels of the canvas. */
  const frame = (node: HTMLCanvasElement) => {
    const own = node.getBoundingClientRect();
    const box = window.box();
    return box === null ? { left: 0, width: own.width } : { left: box.left - own.left, width: box.width };
  };

  useFrame(() => {
    const node = canvas.current;
    if (!node) return;
    const [from, to] = window.current();
    const { left, width } = frame(node);
    const cssWidth = node.clientWidth;
    const ratio = globalThis.devicePixelRatio || 1;
    const last = lanes.map((lane) => `${lane.name}${lane.times.length}`).join();
    const state = `${from} ${to} ${left} ${width} ${cssWidth} ${ratio} ${last} ${scheme} ${under?.lane}/${under?.index}`;
    if (state === drawn.current) return;
    drawn.current = state;
    node.width = Math.round(cssWidth * ratio);
    node.height = Math.round(height * ratio);
    const pen = node.getContext("2d");
    if (!pen) return;
    pen.scale(ratio, ratio);
    const dark = scheme === "dark";
    pen.fillStyle = dark ? "rgba(255,255,255,0.07)" : "rgba(15,23,42,0.07)";
    lanes.forEach((_, row) => {
      pen.fillRect(left, row * LANE_PX + LANE_PX / 2 - 0.5, width, 1);
    });
    pen.save();
    pen.beginPath();
    pen.rect(left - 4, 0, width + 8, height);
    pen.clip();
    lanes.forEach((lane, row) => {
      const middle = row * LANE_PX + LANE_PX / 2;
      const fault = isFault(lane.name);
      pen.fillStyle = fault ? (dark ? "#ff6b6b" : "#d02828") : dark ? "#56b4e9" : "#0068a8";
      lane.times.forEach((time, index) => {
        if (time < from || time > to) return;
        const x = left + ((time - from) / (to - from)) * width;
        const grown = under?.lane === row && under.index === index ? 2 : 0;
        if (fault) {
          // the shape says it as well as the colour
          const size = 4.5 + grown;
          pen.beginPath();
          pen.moveTo(x, middle - size);
          pen.lineTo(x + size, middle);
          pen.lineTo(x, middle + size);
          pen.lineTo(x - size, middle);
          pen.fill();
        } else pen.fillRect(x - 1 - grown / 2, middle - 6 - grown / 2, 2 + grown, 12 + grown);
      });
    });
    pen.restore();
  });

  const point = (event: PointerEvent<HTMLCanvasElement>) => {
    const node = event.currentTarget;
    const own = node.getBoundingClientRect();
    const { left, width } = frame(node);
    const [from, to] = window.current();
    const row = Math.floor((event.clientY - own.top) / LANE_PX);
    const time = from + ((event.clientX - own.left - left) / width) * (to - from);
    const index = nearest(lanes[row], time, (HIT_PX / width) * (to - from));
    setUnder(index === null ? null : { lane: row, index, x: event.clientX - own.left });
  };

  /** Left and right walk along the events that are in sight, in the order of time, and read them out. */
  const walk = (event: KeyboardEvent<HTMLCanvasElement>) => {
    if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
    event.preventDefault();
    const node = event.currentTarget;
    const [from, to] = window.current();
    const seen = lanes
      .flatMap((lane, row) => lane.times.map((time, index) => ({ lane: row, index, time })))
      .filter(({ time }) => time >= from && time <= to)
      .sort((a, b) => a.time - b.time || a.lane - b.lane);
    if (seen.length === 0) {
      setSpoken("No event in this window");
      return;
    }
    const back = event.key === "ArrowLeft";
    const now = seen.findIndex((mark) => mark.lane === under?.lane && mark.index === under.index);
    const next = seen[now < 0 ? (back ? seen.length - 1 : 0) : (now + (back ? -1 : 1) + seen.length) % seen.length];
    if (!next) return;
    const { left, width } = frame(node);
    setUnder({ lane: next.lane, index: next.index, x: left + ((next.time - from) / (to - from)) * width });
    setSpoken(`${lanes[next.lane]?.name} at ${fixed(next.time, 3, "s")}`);
  };

  const lane = under === null ? undefined : lanes[under.lane];
  const time = under === null ? undefined : lane?.times[under.index];
  const before = under === null || under.index === 0 ? undefined : lane?.times[under.index - 1];
  return (
    <div className={classes.lanes}>
      <div className="shrink relative" style={{ height }}>
        <canvas
          ref={canvas}
          className="block w-full"
          style={{ height }}
          tabIndex={0}
          role="img"
          aria-label={`Events of ${name} over time, ${lanes.length} rows. Arrow keys walk along them; the list has them as text.`}
          onPointerMove={point}
          onPointerLeave={() => setUnder(null)}
          onBlur={() => setUnder(null)}
          onKeyDown={walk}
          data-testid="event-lanes"
        />
        {under !== null && lane && time !== undefined && (
          <div
            className={`${classes.tip} absolute pad-s touchless card text-12 tight`}
            style={{ left: under.x, top: under.lane * LANE_PX }}
            data-right={under.x > 300}
            data-testid="event-tip"
          >
            <b>{lane.name}</b> <span className="num">{fixed(time, 4, "s")}</span>
            {before !== undefined && <span className="ml-4 dim">{duration(time - before)} after the last</span>}
            <div>{bits.find((bit) => bit.name === lane.name)?.help}</div>
          </div>
        )}
        <span className="unseen" role="status">
          {spoken}
        </span>
      </div>
      <ul className={classes.names} aria-label="Events that occurred">
        {lanes.map((each) => (
          <li
            key={each.name}
            title={bits.find((bit) => bit.name === each.name)?.help ?? each.name}
            className="row between gap-6 text-12"
            style={{ height: LANE_PX }}
            data-event={each.name}
          >
            <span className={`clip shrink ${isFault(each.name) ? "fault" : ""}`}>{each.name}</span>
            <span className="num dim">{fixed(each.times.length)}</span>
          </li>
        ))}
      </ul>
    </div>
  );
}
