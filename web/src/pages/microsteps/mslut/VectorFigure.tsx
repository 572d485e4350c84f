import { coordinate } from "../../../lib/format";
import { Savable } from "../../../plots/Savable";
import { currentAt, POSITIONS } from "./wave";

interface Wave {
  values: readonly number[];
  mirror: number;
}

const REACH = 148;
const RADIUS = 100;
/** A good wave's vector is a circle to the eye: what its length is off by is drawn this many times larger. */
export const MAGNIFIED = 10;

function vector(wave: Wave, position: number): [length: number, angle: number] {
  const a = currentAt(wave.values, wave.mirror, position) - wave.mirror / 2;
  const b = currentAt(wave.values, wave.mirror, position + POSITIONS / 4) - wave.mirror / 2;
  return [Math.hypot(a, b), Math.atan2(a, b)];
}

function place(wave: Wave, mean: number, position: number): [x: number, y: number] {
  const [length, angle] = vector(wave, position);
  const off = mean > 0 ? length / mean - 1 : 0;
  const radius = Math.min(REACH - 4, Math.max(4, RADIUS * (1 + MAGNIFIED * off)));
  return [radius * Math.cos(angle), -radius * Math.sin(angle)];
}

function path(wave: Wave): string {
  let sum = 0;
  for (let position = 0; position < POSITIONS; position++) sum += vector(wave, position)[0];
  const points = Array.from({ length: POSITIONS }, (_, position) => place(wave, sum / POSITIONS, position));
  return `${points.map(([x, y], at) => `${at === 0 ? "M" : "L"}${coordinate(x, 1)},${coordinate(y, 1)}`).join("")}Z`;
}

interface Props {
  design: Wave;
  before: Wave | null;
  worst: number | null;
  /** what the phases are called */
  phases: { sine: string; cosine: string };
}

/** The current vector over a period, the cosine's phase across and the sine's up; what its length is off by is magnified. */
export function VectorFigure({ design, before, worst, phases }: Props) {
  const angle = worst === null ? null : vector(design, worst)[1];
  return (
    <Savable name={`Current vector, deviations × ${MAGNIFIED}`} className="square">
      <svg
        viewBox={`${-REACH} ${-REACH} ${2 * REACH} ${2 * REACH}`}
        role="img"
        aria-label={`Current vector over a period, ${phases.cosine} across and ${phases.sine} up; deviations of its length ${MAGNIFIED} times larger`}
      >
        <line stroke="var(--line)" strokeWidth={0.8} x1={-REACH} x2={REACH} y1={0} y2={0} />
        <line stroke="var(--line)" strokeWidth={0.8} y1={-REACH} y2={REACH} x1={0} x2={0} />
        <circle fill="none" stroke="var(--grey)" strokeWidth={0.8} strokeDasharray="3 2" r={RADIUS} />
        {before && <path className="fill-none stroke-grey faint" strokeWidth={1.6} d={path(before)} />}
        <path fill="none" stroke="var(--accent)" strokeWidth={1.2} d={path(design)} />
        {angle !== null && (
          <line
            stroke="var(--orange)"
            strokeWidth={1.2}
            x1={0}
            y1={0}
            x2={RADIUS * Math.cos(angle)}
            y2={-RADIUS * Math.sin(angle)}
          />
        )}
        <text className="fill-dim" fontSize={15} x={REACH} y={-4} textAnchor="end">
          {phases.cosine.slice(-1)}
        </text>
        <text className="fill-dim" fontSize={15} x={5} y={-REACH + 12}>
          {phases.sine.slice(-1)}
        </text>
      </svg>
    </Savable>
  );
}
