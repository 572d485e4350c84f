import { useEffect, useRef } from "react";
import { coordinate, fixed } from "../../../lib/format";
import { everyTick, LiveText } from "../../../live/LiveText";
import { degrees, onCircle, sector, zoneOf } from "./angle";
import classes from "./closedloop.module.css";

const RADIUS = 54;
const RING = 9;

interface Props {
  /** the load angle now, electrical [deg]; NaN while unknown */
  read: () => number;
  /** CL_BETA and CL_GAMMA, as the chip holds them; null while unknown */
  beta: number | null;
  gamma: number | null;
  /** the limits bind: closed loop is on, and back-EMF is compensated */
  regulated: boolean;
  emf: boolean;
}

/**
 * One electrical turn, four full steps. The rotor points up; the hand is the field, ahead of it clockwise. Shaded is how
 * far closed loop may lead it.
 */
export function LoadDial({ read, beta, gamma, regulated, emf }: Props) {
  const hand = useRef<SVGGElement>(null);
  const figure = useRef<HTMLElement>(null);
  const betaDeg = degrees(beta ?? 255);
  const gammaDeg = emf && gamma !== null ? degrees(gamma) : 0;
  const latest = useRef({ read, betaDeg });
  latest.current = { read, betaDeg };
  useEffect(
    () =>
      everyTick(() => {
        const angle = latest.current.read();
        hand.current?.setAttribute("transform", `rotate(${Number.isNaN(angle) ? 0 : coordinate(angle, 1)})`);
        if (figure.current) figure.current.dataset.zone = zoneOf(angle, latest.current.betaDeg);
      }),
    [],
  );
  return (
    <figure ref={figure} className={`${classes.dial} m-0`} data-zone="unknown" data-testid="load-dial">
      <svg
        viewBox="-84 -68 168 136"
        role="img"
        aria-label={`Load angle on an electrical turn. Closed loop may lead by ${fixed(betaDeg, 1)} degrees both ways${
          gammaDeg > 0 ? `, at speed by ${fixed(gammaDeg, 1)} more` : ""
        }`}
      >
        <circle r={RADIUS} fill="none" stroke="var(--rule-strong)" />
        {gammaDeg > 0 && (
          <path
            d={sector(-betaDeg - gammaDeg, betaDeg + gammaDeg, RADIUS - RING, RADIUS)}
            fill="color-mix(in srgb, var(--orange) 22%, transparent)"
          />
        )}
        <path
          d={sector(-betaDeg, betaDeg, RADIUS - RING, RADIUS)}
          className={classes.dialBeta}
          data-binds={regulated}
          data-known={beta !== null}
        />
        {[-betaDeg, betaDeg].map((angle) => {
          const inner = onCircle(angle, RADIUS - RING - 3);
          const outer = onCircle(angle, RADIUS + 3);
          return (
            <path
              key={angle}
              d={`M${inner.x} ${inner.y}L${outer.x} ${outer.y}`}
              stroke="var(--violet)"
              strokeWidth={1.5}
            />
          );
        })}
        {(
          [
            [0, "middle"],
            [90, "start"],
            [180, "middle"],
            [-90, "end"],
          ] as const
        ).map(([angle, anchor]) => {
          const at = onCircle(angle, RADIUS + 7);
          return (
            <text key={angle} x={at.x} y={at.y + 3} textAnchor={anchor} fontSize={9} className="fill-dim tabular">
              {fixed(angle)}°
            </text>
          );
        })}
        <path d={`M0 0V-${RADIUS - RING - 4}`} className="stroke-dim stroke-2 dashed" />
        <g ref={hand}>
          <path d={`M-4 6L0 -${RADIUS - RING - 2}L4 6Z`} className={classes.dialHand} />
        </g>
        <circle r={4} fill="var(--ground)" stroke="var(--mantine-color-text)" />
      </svg>
      <figcaption className="hint center tight">
        <span className="figure-20 ink">
          <LiveText read={() => fixed(read(), 1)} data-testid="load-angle" />°
        </span>
        <span>
          CL_BETA {beta === null ? "not known" : `${fixed(beta)}, ±${fixed(betaDeg, 1)}°`}
          {gammaDeg > 0 && `; with CL_GAMMA ±${fixed(betaDeg + gammaDeg, 1)}°`}
        </span>
        <span>{regulated ? "The field is kept inside." : "Closed loop is off: nothing limits it."}</span>
      </figcaption>
    </figure>
  );
}
