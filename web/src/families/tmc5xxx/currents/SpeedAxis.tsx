import { useElementSize, useMergedRef } from "@mantine/hooks";
import { type CSSProperties, type KeyboardEvent, type PointerEvent, useEffect, useRef } from "react";
import { compact, coordinate } from "../../../lib/format";
import { everyTick } from "../../../live/LiveText";
import { widest } from "../../../plots/labels";
import classes from "./currents.module.css";
import type { SpeedLimit } from "./figures";
import {
  chopperZones,
  coolZones,
  type LogAxis,
  linesOf,
  type Modes,
  rpmOf,
  type SpeedScale,
  shareOf,
  speedAt,
  ticksOf,
  type Zone,
} from "./speed";

export interface Threshold {
  register: string;
  /** what it is called on the axis */
  name: string;
  pps: number | null;
  staged: boolean;
  /** what the lane it belongs to is */
  lane: "chopper" | "cool" | "both";
}

interface Props {
  axis: LogAxis;
  scale: SpeedScale;
  modes: Modes;
  thresholds: readonly Threshold[];
  limits: readonly SpeedLimit[];
  /** the speed now [pps]; NaN while unknown */
  now: () => number;
  disabled: boolean;
  onMove: (register: string, pps: number) => void;
}

/** What an arrow key does: 1 %, with Shift 10 %. */
const STEP = 1.01;
/** Between a name and its line, and between names [px]. */
const GAP_PX = 6;
/** How much wider than the plots' text a bold name is. */
const BOLD = 1.12;

/** Every speed threshold on one axis of speeds, and what the driver does between them. */
export function SpeedAxis({ axis, scale, modes, thresholds, limits, now, disabled, onMove }: Props) {
  const box = useRef<HTMLDivElement>(null);
  const needle = useRef<HTMLSpanElement>(null);
  const latest = useRef({ now, axis });
  latest.current = { now, axis };
  useEffect(
    () =>
      everyTick(() => {
        const speed = Math.abs(latest.current.now());
        const mark = needle.current;
        if (!mark) return;
        mark.style.visibility = speed > 0 ? "visible" : "hidden";
        mark.style.left = percent(shareOf(speed, latest.current.axis));
      }),
    [],
  );

  const size = useElementSize();
  const boxRef = useMergedRef(box, size.ref);
  const bounds = (name: string, pps: number, part: number) => {
    const wide = widest([name]) * BOLD + GAP_PX;
    const from = shareOf(pps, axis) * size.width - part * wide;
    return { from, to: from + wide };
  };
  const marks = [...limits]
    .sort((a, b) => a.pps - b.pps)
    .map(({ name, pps }, index) => {
      // the names of two that are close stand either side of them
      const before = (index === 0 && limits.length > 1) || shareOf(pps, axis) > 0.85;
      return { name, pps, before, ...bounds(name, pps, before ? 1 : 0) };
    });
  const known = thresholds.flatMap(({ register, name, pps, lane }) => {
    if (pps === null) return [];
    const edge = edgeOf(shareOf(pps, axis));
    const part = edge === undefined ? 0.5 : edge === "left" ? 0 : 1;
    return [{ key: register, below: lane === "cool", ...bounds(name, pps, part) }];
  });
  const below = [...known.filter((name) => name.below), ...marks.map((mark) => ({ key: mark.name, ...mark }))];
  const above = known.filter((name) => !name.below);
  const lines = new Map([below, above].flatMap((names) => linesOf(names).map((line, at) => [names[at]?.key, line])));
  const most = (names: readonly { key: string }[]) => Math.max(0, ...names.map(({ key }) => lines.get(key) ?? 0));
  const raised = (key: string) => ({ "--at": lines.get(key) ?? 0 });

  function move(register: string, event: PointerEvent) {
    const frame = box.current?.getBoundingClientRect();
    if (!frame) return;
    const share = Math.min(1, Math.max(0, (event.clientX - frame.left) / frame.width));
    onMove(register, speedAt(share, axis));
  }
  function key(threshold: Threshold, event: KeyboardEvent) {
    const sizes: Record<string, number> = {
      ArrowRight: STEP,
      ArrowUp: STEP,
      ArrowLeft: 1 / STEP,
      ArrowDown: 1 / STEP,
      PageUp: 2,
      PageDown: 0.5,
    };
    const factor = sizes[event.key];
    if (factor === undefined || disabled || threshold.pps === null) return;
    const by = event.shiftKey ? factor ** 10 : factor;
    onMove(threshold.register, Math.min(axis.most, Math.max(axis.least, Math.max(axis.least, threshold.pps) * by)));
    event.preventDefault();
  }

  return (
    <div className={classes.axisBox} style={{ "--above": most(above), "--below": most(below) } as CSSProperties}>
      <div className="grid gap-4 relative" ref={boxRef}>
        <Lane label="Chopper" zones={chopperZones(modes, axis)} axis={axis} scale={scale} />
        <Lane label="Load" zones={coolZones(modes, axis)} axis={axis} scale={scale} />
        {marks.map(({ name, pps, before }) => (
          <span
            key={name}
            className={classes.limit}
            data-side={before ? "before" : "after"}
            style={{ left: percent(shareOf(pps, axis)), ...raised(name) } as CSSProperties}
            title={`${name} at ${compact(rpmOf(pps, scale), 3, "rpm")}`}
          >
            <span className={`${classes.limitName} caution text-12 nowrap`}>{name}</span>
          </span>
        ))}
        <span ref={needle} className={classes.needle} style={{ visibility: "hidden" }} title="speed now" />
        {thresholds.map((threshold) =>
          threshold.pps === null ? null : (
            <div
              key={threshold.register}
              role="slider"
              tabIndex={disabled ? -1 : 0}
              className={classes.threshold}
              data-lane={threshold.lane}
              data-staged={threshold.staged}
              data-edge={edgeOf(shareOf(threshold.pps, axis))}
              style={{ left: percent(shareOf(threshold.pps, axis)), ...raised(threshold.register) } as CSSProperties}
              aria-label={`${threshold.register} as a speed`}
              aria-valuemin={Math.round(axis.least)}
              aria-valuemax={Math.round(axis.most)}
              aria-valuenow={Math.round(threshold.pps)}
              aria-valuetext={`${compact(Math.round(threshold.pps), 4, "pps")}, ${compact(rpmOf(threshold.pps, scale), 3, "rpm")}`}
              aria-disabled={disabled}
              onKeyDown={(event) => key(threshold, event)}
              onPointerDown={(event) => {
                if (disabled || event.button !== 0) return;
                event.currentTarget.setPointerCapture(event.pointerId);
                event.currentTarget.focus();
              }}
              onPointerMove={(event) => {
                if (event.currentTarget.hasPointerCapture(event.pointerId)) move(threshold.register, event);
              }}
            >
              <span className={`${classes.thresholdName} text-12 bold nowrap`}>{threshold.name}</span>
            </div>
          ),
        )}
      </div>
      <div className={`${classes.axisTicks} hint`} aria-hidden>
        {ticksOf(axis, scale).map(({ pps, rpm }) => (
          <span key={rpm} style={{ left: percent(shareOf(pps, axis)) }} data-decade={/^1/.test(String(rpm))}>
            {compact(rpm)}
          </span>
        ))}
      </div>
      <div className="hint right">rpm</div>
    </div>
  );
}

function Lane({ label, zones, axis, scale }: { label: string; zones: Zone[]; axis: LogAxis; scale: SpeedScale }) {
  return (
    <ul className={`${classes.lane} list relative`} aria-label={label}>
      {zones.map((zone) => (
        <li
          key={`${zone.kind} ${zone.from}`}
          className={`${classes.zone} center text-12 nowrap ${ZONE_LOOKS[zone.kind]}`}
          style={{
            left: percent(shareOf(zone.from, axis)),
            width: percent(shareOf(zone.to, axis) - shareOf(zone.from, axis)),
          }}
          title={`${zone.name}: ${compact(rpmOf(zone.from, scale), 3)} to ${compact(rpmOf(zone.to, scale), 3, "rpm")}`}
        >
          <span>{zone.name}</span>
        </li>
      ))}
    </ul>
  );
}

/** Near an end of the axis a name stands beside its line, not across the end. */
function edgeOf(share: number): "left" | "right" | undefined {
  if (share < 0.05) return "left";
  return share > 0.95 ? "right" : undefined;
}

const ZONE_LOOKS: Record<Zone["kind"], string> = {
  stealth: "ink tinted hue-blue",
  spread: "ink tinted hue-green",
  high: "ink tinted hue-orange",
  cool: "ink tinted hue-violet",
  off: "dim",
};

const percent = (share: number) => `${coordinate(100 * share, 3)}%`;
