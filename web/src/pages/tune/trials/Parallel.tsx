import { useElementSize } from "@mantine/hooks";
import { type KeyboardEvent, type PointerEvent, useId, useState } from "react";
import { compact, counted } from "../../../lib/format";
import { symbolOf } from "../../../lib/units";
import { Savable } from "../../../plots/Savable";
import classes from "./parallel.module.css";
import { type Line, LOST, nearestTo, parallelOf, saidOf, type Trials } from "./points";
import { useStateColors } from "./useStateColors";

interface Props {
  trials: Trials;
  label?: string | undefined;
}

/** Upright axes: where they begin below their texts, and end above the last one [px]. */
const UPRIGHT = { top: 54, bottom: 206, height: 226 };
/** Lying ones, each below its text, where upright ones have no room for theirs [px]. */
const LYING = { first: 24, step: 42, edge: 8 };
const LETTER = 6.8;
const LINE = 15;
const STEPS: Readonly<Record<string, number>> = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };

/** Parallel coordinates: a line a trial across all settings and figures; the best is thick, and on top. */
export function Parallel({ trials, label = "All settings and figures of each trial" }: Props) {
  const { ref, width } = useElementSize<HTMLDivElement>();
  const help = useId();
  const [picked, setPicked] = useState<number | null>(null);
  const colors = useStateColors();
  const { axes, lines } = parallelOf(trials);
  if (lines.length < 2 || axes.length < 3) return null;
  const { best, lost = LOST } = trials;
  const wide = width || 320;
  const longest = LETTER * Math.max(...axes.flatMap(({ name, unit }) => [name.length, unit.length]));
  const upright = wide >= axes.length * (longest + 8);
  const first = upright ? longest / 2 : LYING.first;
  const step = upright ? (wide - longest) / (axes.length - 1) : LYING.step;
  const [zero, one] = upright ? [UPRIGHT.bottom, UPRIGHT.top] : [LYING.edge, wide - LYING.edge];
  const xy = (index: number, height: number) => {
    const [along, across] = [first + step * index, zero + (one - zero) * height];
    return upright ? ([along, across] as const) : ([across, along] as const);
  };
  const shown = lines.find(({ point }) => point.number === picked)?.point ?? null;
  const rank = ({ point }: Line) => (point === shown ? 3 : point.number === best ? 2 : point.state === "held" ? 1 : 0);
  const pick = ({ currentTarget, clientX, clientY }: PointerEvent) => {
    const { left, top } = currentTarget.getBoundingClientRect();
    const [along, across] = upright ? [clientX - left, clientY - top] : [clientY - top, clientX - left];
    setPicked(nearestTo(lines, (along - first) / step, (across - zero) / (one - zero))?.number ?? null);
  };
  const walk = (event: KeyboardEvent) => {
    const by = STEPS[event.key];
    if (by === undefined) return;
    event.preventDefault();
    const at = lines.findIndex(({ point }) => point === shown);
    const start = lines.findIndex(({ point }) => point.number === best);
    const next = at < 0 ? Math.max(start, 0) : Math.max(0, Math.min(at + by, lines.length - 1));
    setPicked(lines[next]?.point.number ?? null);
  };
  return (
    <Savable name={label} low>
      <figure className={classes.parallel} aria-label={label}>
        <div
          ref={ref}
          role="img"
          aria-label={`${label}: ${counted(lines.length, "trial")} across ${axes.map(({ name }) => name).join(", ")}`}
          aria-describedby={help}
          // biome-ignore lint/a11y/noNoninteractiveTabindex: arrow keys go from trial to trial, which the line below reads out
          tabIndex={0}
          className={classes.plot}
          onKeyDown={walk}
        >
          <svg
            width={wide}
            height={upright ? UPRIGHT.height : LYING.first + LYING.step * (axes.length - 1) + LYING.edge}
            aria-hidden="true"
            focusable="false"
            onPointerMove={pick}
            onPointerDown={pick}
            onPointerLeave={({ pointerType }) => pointerType === "mouse" && setPicked(null)}
          >
            {axes.map(({ name }, index) => {
              const [[x1, y1], [x2, y2]] = [xy(index, 0), xy(index, 1)];
              return <line key={name} {...{ x1, y1, x2, y2 }} className={classes.axis} />;
            })}
            {[...lines]
              .sort((a, b) => rank(a) - rank(b))
              .map(({ point, heights }) => (
                <polyline
                  key={point.number}
                  points={heights
                    .flatMap((height, index) => (height === null ? [] : [xy(index, height).join()]))
                    .join(" ")}
                  className={point === shown ? classes.picked : point.number === best ? classes.best : classes.line}
                  stroke={point.state === "held" ? colors.held : colors.lost}
                  strokeDasharray={point.state === "held" ? undefined : "5 4"}
                />
              ))}
            {axes.map(({ name, unit, low, high }, index) => {
              const symbol = symbolOf(unit);
              const along = first + step * index;
              return upright ? (
                <g key={name} textAnchor="middle">
                  <text x={along} y={LINE - 3} className={classes.name}>
                    {name}
                  </text>
                  <text x={along} y={2 * LINE - 3}>
                    {symbol}
                  </text>
                  <text x={along} y={UPRIGHT.top - 5}>
                    {compact(high, 3)}
                  </text>
                  <text x={along} y={UPRIGHT.bottom + LINE}>
                    {compact(low, 3)}
                  </text>
                </g>
              ) : (
                <g key={name}>
                  <text x={0} y={along - 8}>
                    <tspan className={classes.name}>{name}</tspan> {symbol}
                  </text>
                  <text x={wide} y={along - 8} textAnchor="end">
                    {compact(low, 3)} → {compact(high, 3)}
                  </text>
                </g>
              );
            })}
          </svg>
        </div>
        <p id={help} className="unseen">
          Arrow keys go from trial to trial.
        </p>
        <output className={classes.said} aria-live="polite">
          {shown ? saidOf(trials, shown) : "Point at a line, or go from trial to trial with the arrow keys."}
        </output>
        <figcaption className={classes.legend}>
          <span>
            <i style={{ color: colors.held }} /> held
          </span>
          {lines.some(({ point }) => point.state === "lost") && (
            <span>
              <i className={classes.dashed} style={{ color: colors.lost }} /> {lost}
            </span>
          )}
          {lines.some(({ point }) => point.number === best) && (
            <span>
              <i className={classes.thick} style={{ color: colors.held }} /> best
            </span>
          )}
        </figcaption>
      </figure>
    </Savable>
  );
}
