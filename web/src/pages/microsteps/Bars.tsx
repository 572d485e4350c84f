import { useElementSize } from "@mantine/hooks";
import { type KeyboardEvent, type PointerEvent, useState } from "react";
import { Savable } from "../../plots/Savable";
import classes from "./Microsteps.module.css";

export interface Bar {
  label: string;
  value: number | null;
  before: number | null;
}

interface Props {
  label: string;
  bars: readonly Bar[];
  height?: number;
  /** y from low to high, with the values at which a line is drawn */
  scale: { low: number; high: number; ticks: readonly number[]; log?: boolean };
  format: (value: number | null) => string;
  /** this one is named */
  marked: number | null;
  every: number;
}

const LEFT = 50;
const BOTTOM = 18;
const TOP = 6;

/** Bars with the ones from before as outlines; one can be looked at with pointer or arrow keys. */
export function Bars({ label, bars, height = 150, scale, format, marked, every }: Props) {
  const { ref, width } = useElementSize<HTMLDivElement>();
  const [at, setAt] = useState<number | null>(null);
  const inner = Math.max(60, width - LEFT - 8);
  const tall = height - TOP - BOTTOM;
  const pitch = inner / Math.max(1, bars.length);
  const place = (value: number) => {
    const share = scale.log
      ? (Math.log(Math.max(scale.low, value)) - Math.log(scale.low)) / (Math.log(scale.high) - Math.log(scale.low))
      : (value - scale.low) / (scale.high - scale.low);
    return TOP + (1 - Math.min(1, Math.max(0, share))) * tall;
  };
  const zero = place(scale.log ? scale.low : 0);
  const seen = at ?? marked;
  const bar = seen === null ? undefined : bars[seen];
  const span = (value: number) => ({
    y: Math.min(zero, place(value)),
    height: Math.max(value === 0 ? 0 : 1, Math.abs(zero - place(value))),
  });
  const told = bar
    ? `${bar.label}: ${format(bar.value)}${bar.before === null ? "" : `, before ${format(bar.before)}`}`
    : "";

  function onPointer(event: PointerEvent<HTMLDivElement>) {
    const px = event.clientX - event.currentTarget.getBoundingClientRect().left - LEFT;
    const index = Math.floor(px / pitch);
    setAt(index >= 0 && index < bars.length ? index : null);
  }

  function onKey(event: KeyboardEvent) {
    const from = seen ?? 0;
    const to = { ArrowLeft: from - 1, ArrowRight: from + 1, Home: 0, End: bars.length - 1 }[event.key];
    if (to === undefined) return;
    setAt(Math.min(bars.length - 1, Math.max(0, to)));
    event.preventDefault();
  }

  return (
    <Savable name={label}>
      <div
        ref={ref}
        className={classes.bars}
        role="slider"
        tabIndex={0}
        aria-label={label}
        aria-valuemin={0}
        aria-valuemax={Math.max(0, bars.length - 1)}
        aria-valuenow={seen ?? 0}
        aria-valuetext={told || "nothing to show"}
        onPointerMove={onPointer}
        onPointerLeave={() => setAt(null)}
        onKeyDown={onKey}
        onBlur={() => setAt(null)}
      >
        <p className="room flex gap-12 m-0 text-12">
          <span className="num">{told || " "}</span>
        </p>
        <svg width="100%" height={height} aria-hidden="true">
          {scale.ticks.map((value) => (
            <g key={value}>
              <line className="grid-line faint" x1={LEFT} x2={LEFT + inner} y1={place(value)} y2={place(value)} />
              <text className="tick" x={LEFT - 6} y={place(value)} textAnchor="end" dominantBaseline="central">
                {format(value)}
              </text>
            </g>
          ))}
          {seen !== null && (
            <rect className={classes.looked} x={LEFT + seen * pitch} y={TOP} width={pitch} height={tall} />
          )}
          {bars.map((entry, index) => (
            <g key={entry.label}>
              {entry.before !== null && (
                <rect
                  fill="var(--grey)"
                  opacity={0.35}
                  x={LEFT + (index + 0.1) * pitch}
                  width={pitch * 0.8}
                  {...span(entry.before)}
                />
              )}
              {entry.value !== null && (
                <rect
                  className={index === marked ? "fill-orange" : "fill-accent"}
                  x={LEFT + (index + 0.22) * pitch}
                  width={Math.max(0.6, pitch * 0.56)}
                  {...span(entry.value)}
                />
              )}
              {index % every === 0 && (
                <text className="tick" x={LEFT + (index + 0.5) * pitch} y={height - 4} textAnchor="middle">
                  {entry.label.replace(/\D/g, "")}
                </text>
              )}
            </g>
          ))}
        </svg>
      </div>
    </Savable>
  );
}
