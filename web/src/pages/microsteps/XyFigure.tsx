import type { Schemas } from "../../api/client";
import { Savable } from "../../plots/Savable";
import classes from "./Microsteps.module.css";

interface Props {
  rows: readonly Schemas["SequencerRow"][];
  before: readonly Schemas["SequencerRow"][] | null;
  /** the step to show with a hand: the worst one */
  worst: number | null;
}

const REACH = 70;

function path(rows: readonly Schemas["SequencerRow"][]): string {
  return `${rows.map((row, index) => `${index === 0 ? "M" : "L"}${row.current_b},${-row.current_a}`).join("")}Z`;
}

/** The current vector over a period: phase B across, phase A up, beside the ideal circle. */
export function XyFigure({ rows, before, worst }: Props) {
  const hand = worst === null ? undefined : rows[worst];
  const next = worst === null ? undefined : rows[(worst + 1) % Math.max(1, rows.length)];
  return (
    <Savable name="Current vector over a period" className="square">
      <svg
        viewBox={`${-REACH} ${-REACH} ${2 * REACH} ${2 * REACH}`}
        role="img"
        aria-label="Current vector over a period, phase B across and phase A up, beside the ideal circle"
      >
        <line stroke="var(--line)" strokeWidth={0.5} x1={-REACH} x2={REACH} y1={0} y2={0} />
        <line stroke="var(--line)" strokeWidth={0.5} y1={-REACH} y2={REACH} x1={0} x2={0} />
        <circle fill="none" stroke="var(--grey)" strokeWidth={0.5} strokeDasharray="2 1.5" r={63} />
        {before && <path className="fill-none stroke-grey faint" strokeWidth={1.1} d={path(before)} />}
        <path fill="none" stroke="var(--accent)" strokeWidth={0.8} d={path(rows)} />
        {rows.map((row) => (
          <circle key={row.index} className="fill-accent" cx={row.current_b} cy={-row.current_a} r={0.9} />
        ))}
        {hand && next && (
          <g className={classes.xyWorst}>
            <line x1={0} y1={0} x2={hand.current_b} y2={-hand.current_a} />
            <line x1={0} y1={0} x2={next.current_b} y2={-next.current_a} />
            <line x1={hand.current_b} y1={-hand.current_a} x2={next.current_b} y2={-next.current_a} />
          </g>
        )}
        <text className="fill-dim" fontSize={7} x={REACH} y={-2} textAnchor="end">
          B
        </text>
        <text className="fill-dim" fontSize={7} x={3} y={-REACH + 6.5}>
          A
        </text>
      </svg>
    </Savable>
  );
}
