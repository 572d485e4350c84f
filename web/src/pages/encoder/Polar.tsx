import { useRef } from "react";
import { coordinate, fixed } from "../../lib/format";
import { useFrame } from "../../live/useFrame";
import { Savable } from "../../plots/Savable";
import type { AngleMap, Direction } from "./angleMap";
import classes from "./encoder.module.css";
import { bandPath, meanPath, pointAt, type Ring, reachOf } from "./polar";
import { useMapChanges } from "./useEncoder";

const SIZE = 360;
const RING: Ring = { centre: SIZE / 2, zero: 96, span: 58 };
const SPOKES = Array.from({ length: 12 }, (_, index) => index * 30);

export interface Curve {
  map: AngleMap;
  color: string;
  label: string;
}

interface Props {
  curves: readonly Curve[];
  direction: Direction;
  /** the shaft's angle now, as a share of a turn; NaN while unknown */
  shaft: () => number;
  summary: string;
}

/** Deviation around the shaft: the ring is deviation 0, outside is ahead. Each point is the mean of a full step. */
export function Polar({ curves, direction, shaft, summary }: Props) {
  const lines = useRef<(SVGPathElement | null)[]>([]);
  const bands = useRef<(SVGPathElement | null)[]>([]);
  const outer = useRef<SVGTextElement>(null);
  const inner = useRef<SVGTextElement>(null);
  const needle = useRef<SVGGElement>(null);
  const reach = useRef(1);

  useMapChanges(
    curves.map((curve) => curve.map),
    `${direction} ${curves.map((curve) => curve.label).join()}`,
    () => {
      const tables = curves.map(({ map }) => map.turn(direction, map.fullStepsPerTurn));
      reach.current = reachOf(tables, reach.current);
      tables.forEach((bins, index) => {
        lines.current[index]?.setAttribute("d", meanPath(bins, RING, reach.current));
        bands.current[index]?.setAttribute("d", bandPath(bins, RING, reach.current));
      });
      if (outer.current) outer.current.textContent = `+${fixed(reach.current)}`;
      if (inner.current) inner.current.textContent = fixed(-reach.current);
    },
  );
  useFrame(() => {
    const share = shaft();
    if (!needle.current) return;
    needle.current.style.visibility = Number.isNaN(share) ? "hidden" : "visible";
    if (!Number.isNaN(share)) needle.current.setAttribute("transform", `rotate(${coordinate(share * 360, 1)} 180 180)`);
  });

  const [x0, y0] = pointAt(RING, 0, 0, 1);
  return (
    <Savable name="Deviation around the shaft" className={classes.polar}>
      <svg viewBox={`0 0 ${SIZE} ${SIZE}`} className={classes.polar} role="img" aria-label={summary}>
        {[-1, 0, 1].map((level) => (
          <circle
            key={level}
            cx={RING.centre}
            cy={RING.centre}
            r={RING.zero + level * RING.span}
            className={level === 0 ? classes.zeroRing : classes.ring}
          />
        ))}
        {SPOKES.map((angle) => {
          const share = angle / 360;
          const [ax, ay] = pointAt(RING, share, -1, 1);
          const [bx, by] = pointAt(RING, share, 1, 1);
          const [tx, ty] = pointAt(RING, share, 1.22, 1);
          return (
            <g key={angle}>
              <path d={`M${ax} ${ay}L${bx} ${by}`} className={classes.spoke} />
              <text x={tx} y={ty + 4} textAnchor="middle" className="tick">
                {angle}°
              </text>
            </g>
          );
        })}
        {curves.map(({ color, label }, index) => (
          <g key={label}>
            <path
              ref={(node) => {
                bands.current[index] = node;
              }}
              fill={color}
              opacity={0.22}
            />
            <path
              ref={(node) => {
                lines.current[index] = node;
              }}
              fill="none"
              stroke={color}
              strokeWidth={1.6}
              strokeLinejoin="round"
            />
          </g>
        ))}
        <g ref={needle} style={{ visibility: "hidden" }}>
          <path
            d={`M180 180V${RING.centre - RING.zero + RING.span + 6}`}
            stroke="var(--mantine-color-text)"
            strokeWidth={1.2}
          />
          <circle cx={180} cy={180} r={4} className="fill-text" />
        </g>
        <text x={x0 + 5} y={RING.centre - RING.zero - RING.span + 13} className="tick" ref={outer} />
        <text x={x0 + 5} y={y0 + 12} className="tick">
          0
        </text>
        <text x={x0 + 5} y={RING.centre - RING.zero + RING.span + 12} className="tick" ref={inner} />
        <text x={180} y={212} textAnchor="middle" className="tick">
          µsteps
        </text>
      </svg>
    </Savable>
  );
}
