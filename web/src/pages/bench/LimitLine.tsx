import { Text } from "@mantine/core";
import { useEffect, useRef } from "react";
import type { Device } from "../../api/queries";
import { coordinate, withUnit } from "../../lib/format";
import { fromSteps, ratesOf, scaleOf } from "../../lib/units";
import { everyTick } from "../../live/LiveText";
import classes from "./limits.module.css";
import type { LiveAxis } from "./live";

interface Props {
  device: Device;
  axis: Device["axes"][number];
  live: LiveAxis;
  /** what positions are shown in */
  unit: string;
}

/** From this share of a range on, measured from its middle, an axis is near its end. */
const NEAR = 0.9;

/** The soft limits of an axis that has some, and how near it is to them. */
export function LimitLine({ device, axis, live, unit }: Props) {
  const { limits } = axis;
  const scale = scaleOf(axis, device.clock_hz);
  const marker = useRef<HTMLSpanElement>(null);
  const fill = useRef<HTMLSpanElement>(null);
  const from = limits.position_min;
  const to = limits.position_max;
  const speed = limits.velocity_max_pps;

  useEffect(
    () =>
      everyTick(() => {
        const share = placeIn(live.read("position"), from, to);
        if (marker.current) {
          marker.current.hidden = Number.isNaN(share);
          marker.current.style.left = `${coordinate(share * 100)}%`;
          marker.current.dataset.near = String(Math.abs(share - 0.5) * 2 > NEAR);
        }
        const used = Math.abs(live.read("velocity")) / (speed ?? Number.NaN);
        if (fill.current) {
          fill.current.style.width = `${coordinate(Math.min(1, Number.isNaN(used) ? 0 : used) * 100, 1)}%`;
          fill.current.dataset.near = String(used > NEAR);
        }
      }),
    [live, from, to, speed],
  );

  const ranged = from !== null || to !== null;
  const others = otherLimits(limits);
  const place = (value: number | null, none: string) => {
    if (value === null) return none;
    const shown = fromSteps(value, unit, scale, "position");
    return Number.isNaN(shown) ? withUnit(value, "microsteps") : withUnit(shown, unit);
  };
  const rate = ratesOf(unit, scale).velocity;
  const fastest = speed === null ? Number.NaN : fromSteps(speed, rate, scale, "velocity");
  return (
    <section
      className={`${classes.limits} lines-16 rigid text-12`}
      aria-label={`Soft limits of ${axis.name}`}
      data-testid="limits"
    >
      {ranged && (
        <div className={`${classes.row} row shrink gap-8`}>
          <span className="dim">Range</span>
          <span className="num">{place(from, "no end")}</span>
          <span className={classes.track} data-from={from !== null} data-to={to !== null} aria-hidden>
            <span ref={marker} className={classes.marker} hidden />
          </span>
          <span className="num">{place(to, "no end")}</span>
        </div>
      )}
      {speed !== null && (
        <div className={`${classes.row} row shrink gap-8`}>
          <span className="dim">Speed</span>
          <span className={classes.track} data-from data-to aria-hidden>
            <span ref={fill} className={classes.fill} />
          </span>
          <span className="num">{Number.isNaN(fastest) ? withUnit(speed, "pps") : withUnit(fastest, rate)}</span>
        </div>
      )}
      {others !== "" && <span className="dim">{others}</span>}
      {axis.limit_warnings.map((warning) => (
        <Text key={warning} size="xs" className={classes.warning} role="status">
          {warning}
        </Text>
      ))}
    </section>
  );
}

/** Where a position is in its range, 0..1; of a range with one end alone, as if the other were as far from 0. */
function placeIn(position: number, from: number | null, to: number | null): number {
  const low = from ?? -Math.abs(to ?? Number.NaN);
  const high = to ?? Math.abs(from ?? Number.NaN);
  const share = high > low ? (position - low) / (high - low) : 0.5 + 0 * position;
  return Math.max(0, Math.min(1, share));
}

function otherLimits(limits: Device["axes"][number]["limits"]): string {
  const { acceleration_max_pps2: acceleration, current_max_a: current } = limits;
  return [
    acceleration === null ? "" : `at most ${withUnit(acceleration, "pps2")}`,
    current === null ? "" : `at most ${withUnit(current, "A", 3)} rms`,
  ]
    .filter((text) => text !== "")
    .join(", ");
}
