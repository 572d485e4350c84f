import { useElementSize } from "@mantine/hooks";
import type { KeyboardEvent, PointerEvent } from "react";
import type { Schemas } from "../../../api/client";
import { duration, fixed } from "../../../lib/format";
import { labelOf, type Model, type Pair } from "./design";
import classes from "./Ramps.module.css";

export type Candidate = Schemas["PmulPdivCandidate"];

interface Props {
  model: Model;
  candidates: readonly Candidate[];
  chosen: Pair | null;
  recommended: Pair | null;
  onChoose: (pair: Pair) => void;
}

const LEFT = 44;
const RIGHT = 12;
const TOP = 8;
const PLOT = 120;
const LANE = 30;
const HEIGHT = TOP + PLOT + 2 * LANE + 26;

const same = (a: Pair | null, b: Pair | null) => a !== null && b !== null && a.pmul === b.pmul && a.pdiv === b.pdiv;

/** In rising order of q: the order of the chart. */
export function sorted(candidates: readonly Candidate[]): Candidate[] {
  return [...candidates].sort((a, b) => a.quality - b.quality || a.pdiv - b.pdiv);
}

/**
 * The quality q of each pair that comes near p, with what it does at the target. One control: click a pair, or walk
 * with the arrow keys.
 */
export function CandidateChart({ model, candidates, chosen, recommended, onChoose }: Props) {
  const { ref, width } = useElementSize<HTMLDivElement>();
  const rows = sorted(candidates);
  const at = rows.findIndex((row) => same(row, chosen));
  const current = rows[at];
  const low = Math.min(0.92, ...rows.map((row) => row.quality)) - 0.005;
  const high = Math.max(1.02, ...rows.map((row) => row.quality)) + 0.005;
  const inner = Math.max(60, width - LEFT - RIGHT);
  const pitch = inner / Math.max(1, rows.length);
  const x = (index: number) => LEFT + (index + 0.5) * pitch;
  const y = (q: number) => TOP + ((high - q) / (high - low)) * PLOT;
  const mostOver = Math.max(1, ...rows.map((row) => row.overshoot_steps ?? 0));
  const longest = Math.max(1e-9, ...rows.map((row) => row.settling_s ?? 0));
  const bar = Math.min(10, pitch * 0.6);
  const overTop = TOP + PLOT + 6;
  const settleTop = overTop + LANE;
  const every = Math.max(1, Math.ceil(30 / pitch));

  function choose(index: number) {
    const row = rows[Math.max(0, Math.min(rows.length - 1, index))];
    if (row) onChoose({ pmul: row.pmul, pdiv: row.pdiv });
  }

  function onKey(event: KeyboardEvent) {
    const from = at < 0 ? rows.length - 1 : at;
    const to = {
      ArrowRight: from + 1,
      ArrowUp: from + 1,
      ArrowLeft: from - 1,
      ArrowDown: from - 1,
      PageUp: from + 5,
      PageDown: from - 5,
      Home: 0,
      End: rows.length - 1,
    }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    choose(to);
  }

  function onPointer(event: PointerEvent<HTMLDivElement>) {
    if (event.buttons !== 1) return;
    const px = event.clientX - event.currentTarget.getBoundingClientRect().left;
    choose(Math.floor((px - LEFT) / pitch));
  }

  const base = model === "tmc4210" ? 128 : 0;
  const told = (row: Candidate) =>
    [
      `${labelOf(model, "pmul")} ${row.pmul + base}, ${labelOf(model, "pdiv")} ${row.pdiv}`,
      `q ${fixed(row.quality, 4)}`,
      row.overshoot_steps === null ? "never settles" : `overshoot ${row.overshoot_steps} microsteps`,
      row.settling_s === null ? "" : `settling ${duration(row.settling_s)}`,
    ]
      .filter(Boolean)
      .join(", ");

  return (
    <div
      ref={ref}
      className={classes.candidates}
      role="slider"
      tabIndex={0}
      aria-label="Pair of pmul and pdiv, by quality"
      aria-valuemin={0}
      aria-valuemax={Math.max(0, rows.length - 1)}
      aria-valuenow={Math.max(0, at)}
      aria-valuetext={current ? told(current) : "none of these is chosen"}
      onKeyDown={onKey}
      onPointerDown={onPointer}
      onPointerMove={onPointer}
    >
      <svg width="100%" height={HEIGHT} aria-hidden="true">
        <rect fill="var(--accent)" opacity={0.12} x={LEFT} y={y(1)} width={inner} height={y(0.95) - y(1)} />
        {[0.92, 0.95, 1].map((q) => (
          <g key={q}>
            <line className="grid-line" x1={LEFT} x2={LEFT + inner} y1={y(q)} y2={y(q)} />
            <text className="tick" x={LEFT - 6} y={y(q)} textAnchor="end" dominantBaseline="central">
              {fixed(q, 2)}
            </text>
          </g>
        ))}
        <text className="tick" x={LEFT - 6} y={TOP + 4} textAnchor="end" dominantBaseline="hanging">
          q
        </text>
        <text className="tick" x={2} y={overTop + LANE / 2} dominantBaseline="central">
          over
        </text>
        <text className="tick" x={2} y={settleTop + LANE / 2} dominantBaseline="central">
          settle
        </text>
        {[overTop + LANE - 3, settleTop + LANE - 3].map((line) => (
          <line key={line} className="grid-line" x1={LEFT} x2={LEFT + inner} y1={line} y2={line} />
        ))}
        {at >= 0 && (
          <rect
            fill="var(--accent)"
            opacity={0.14}
            x={x(at) - pitch / 2}
            y={TOP}
            width={pitch}
            height={settleTop + LANE - 3 - TOP}
          />
        )}
        {rows.map((row, index) => {
          const overshoots = row.overshoot_steps === null || row.overshoot_steps > 0;
          const over =
            row.overshoot_steps === null
              ? LANE - 8
              : (Math.log1p(row.overshoot_steps) / Math.log1p(mostOver)) * (LANE - 14);
          const settle = ((row.settling_s ?? 0) / longest) * (LANE - 14);
          return (
            <g key={`${row.pmul}/${row.pdiv}`}>
              <circle
                className={overshoots ? classes.pairOver : "fill-accent"}
                cx={x(index)}
                cy={y(row.quality)}
                r={same(row, chosen) ? 6 : 4}
              />
              {same(row, recommended) && (
                <circle className="fill-none stroke-text stroke-1" cx={x(index)} cy={y(row.quality)} r={9} />
              )}
              <rect
                className="fill-orange"
                x={x(index) - bar / 2}
                y={overTop + LANE - 3 - over}
                width={bar}
                height={over}
              />
              {pitch >= 22 && row.overshoot_steps !== null && row.overshoot_steps > 0 && (
                <text
                  className={`${classes.barValue} tick`}
                  x={x(index)}
                  y={overTop + LANE - 5 - over}
                  textAnchor="middle"
                >
                  {row.overshoot_steps}
                </text>
              )}
              {row.overshoot_steps === null && (
                <text className={`${classes.barValue} tick`} x={x(index)} y={overTop + 6} textAnchor="middle">
                  ∞
                </text>
              )}
              <rect
                fill="var(--violet)"
                x={x(index) - bar / 2}
                y={settleTop + LANE - 3 - settle}
                width={bar}
                height={settle}
              />
              {index % every === 0 && (
                <text className="tick" x={x(index)} y={settleTop + LANE + 10} textAnchor="middle">
                  {row.pmul + base}
                </text>
              )}
            </g>
          );
        })}
      </svg>
    </div>
  );
}
