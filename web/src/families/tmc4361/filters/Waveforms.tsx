import { useElementSize } from "@mantine/hooks";
import { type KeyboardEvent, type PointerEvent, useRef, useState } from "react";
import { Savable } from "../../../plots/Savable";
import classes from "./filters.module.css";
import { cellOf, type Filtered, fates, painted, ticksOf, timeText, wavePath } from "./waves";

const LEFT = 92;
const RIGHT = 14;
const HIGH = 26;
const ROWS = { input: 34, samples: 92, output: 128 };
const AXIS = 172;
const HEIGHT = 204;
/** More sample lines than a line every four pixels are a grey wash. */
const LINE_PX = 4;

interface Props {
  pin: string;
  input: readonly number[];
  /** undefined while the first answer is awaited */
  result: Filtered | undefined;
  stale: boolean;
  clockHz: number;
  onInput: (levels: number[]) => void;
}

/**
 * The pin, the samples taken of it, and what the chip works with, over time as in figures 6.1 to 6.3 of DS-TMC4361. The pin's
 * line is drawn by hand: a stroke sets levels, the keys do the same cell by cell.
 */
export function Waveforms({ pin, input, result, stale, clockHz, onInput }: Props) {
  const { ref: box, width: boxWidth } = useElementSize();
  const stroke = useRef<{ from: number; level: number; before: readonly number[] } | null>(null);
  const [cursor, setCursor] = useState<number | null>(null);
  const clocks = input.length;
  const cell = cellOf(clocks);
  const width = Math.max(300, Math.floor(boxWidth));
  const x = (clock: number) => LEFT + (clock / clocks) * (width - LEFT - RIGHT);
  const levelY = (row: number) => (level: number) => row + HIGH * (1 - level);
  const fits = result !== undefined && result.output.length === clocks ? result : undefined;
  const { passed, stopped } = fits ? fates(fits) : { passed: [], stopped: [] };
  const spacing = fits ? x(fits.bounds.period_clocks) - x(0) : 0;
  const spanS = clocks / clockHz;

  const clockAt = (event: PointerEvent<SVGSVGElement>) => {
    const own = event.currentTarget.getBoundingClientRect();
    const share = (event.clientX - own.left - LEFT) / (width - LEFT - RIGHT);
    return Math.min(clocks - 1, Math.max(0, Math.floor(share * clocks)));
  };
  const begin = (event: PointerEvent<SVGSVGElement>) => {
    const own = event.currentTarget.getBoundingClientRect();
    const row = event.clientY - own.top;
    if (event.button !== 0 || row > ROWS.samples - 8 || event.clientX - own.left < LEFT - 4) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    const from = clockAt(event);
    stroke.current = { from, level: 1 - (input[from] ?? 0), before: input };
    setCursor(from);
    onInput(painted(input, from, from, stroke.current.level));
  };
  const move = (event: PointerEvent<SVGSVGElement>) => {
    const pen = stroke.current;
    if (!pen) return;
    onInput(painted(pen.before, pen.from, clockAt(event), pen.level));
  };
  const end = () => {
    stroke.current = null;
  };
  const onKey = (event: KeyboardEvent<SVGSVGElement>) => {
    const at = cursor ?? 0;
    const go = (by: number) => setCursor(Math.min(clocks - 1, Math.max(0, at + by)));
    if (event.key === "ArrowLeft") go(event.shiftKey ? -8 * cell : -cell);
    else if (event.key === "ArrowRight") go(event.shiftKey ? 8 * cell : cell);
    else if (event.key === "Home") setCursor(0);
    else if (event.key === "End") setCursor(clocks - 1);
    else if (event.key === " " || event.key === "Enter") onInput(painted(input, at, at, 1 - (input[at] ?? 0)));
    else return;
    event.preventDefault();
  };
  const spoken =
    cursor === null
      ? ""
      : `${timeText(cursor / clockHz)}: pin ${input[cursor]}, filtered ${fits ? fits.output[cursor] : "unknown"}`;

  return (
    <Savable name={`${pin} before and after its filter`}>
      <div ref={box} className={`${classes.figure} shrink hidden`} data-stale={stale}>
        <svg
          width={width}
          height={HEIGHT}
          role="application"
          aria-roledescription="waveform"
          aria-label={`${pin} before and after its filter. Left and right move, space changes the level.`}
          // biome-ignore lint/a11y/noNoninteractiveTabindex: its waveform is drawn with the keys too
          tabIndex={0}
          className={classes.waves}
          onPointerDown={begin}
          onPointerMove={move}
          onPointerUp={end}
          onPointerCancel={end}
          onKeyDown={onKey}
          data-testid="waveforms"
        >
          {ticksOf(spanS, (width - LEFT - RIGHT) / 80).map((at) => (
            <g key={at}>
              <path d={`M${x(at * clockHz)} ${AXIS} v5`} className="stroke-grey" />
              <text className="tick" x={x(at * clockHz)} y={AXIS + 18} textAnchor="middle">
                {timeText(at)}
              </text>
            </g>
          ))}
          {stopped.map(({ from, to }) => (
            <rect
              key={from}
              x={x(from)}
              width={Math.max(1.5, x(to) - x(from))}
              y={ROWS.input - 6}
              height={HIGH + 12}
              fill="color-mix(in srgb, var(--orange) 22%, transparent)"
              data-testid="stopped"
            >
              <title>
                {timeText((to - from) / clockHz)} long, {to - from} clocks: it does not get through
              </title>
            </rect>
          ))}
          {fits &&
            spacing >= LINE_PX &&
            fits.sample_clocks.map((clock) => (
              <path key={clock} d={`M${x(clock)} ${ROWS.input - 8} V${AXIS}`} stroke="var(--rule)" />
            ))}
          {passed.map(({ from, to }) => (
            <g key={to} className={classes.passed} data-testid="passed">
              <path d={`M${x(from)} ${ROWS.input + HIGH + 4} L${x(to)} ${ROWS.output - 4}`} />
              <title>
                {timeText((to - from) / clockHz)} late, {to - from} clocks
              </title>
            </g>
          ))}
          <path d={wavePath(input, x, levelY(ROWS.input))} className={classes.input} />
          {fits?.samples.map((level, index) => (
            <circle
              key={fits.sample_clocks[index]}
              cx={x(fits.sample_clocks[index] ?? 0)}
              cy={ROWS.samples + 10 - 10 * level + 2}
              r={spacing < 6 ? 1.4 : 2.4}
              className={classes.sample}
              data-high={level === 1}
            />
          ))}
          {fits && <path d={wavePath(fits.output, x, levelY(ROWS.output))} className={classes.output} />}
          {cursor !== null && (
            <rect
              x={x(Math.floor(cursor / cell) * cell)}
              width={Math.max(2, x(cell) - x(0))}
              y={ROWS.input - 8}
              height={HIGH + 16}
              className="fill-none stroke-accent"
            />
          )}
          <g className="text-12 bold fill-text">
            <text x={4} y={ROWS.input + 17}>
              {pin}
            </text>
            <text x={4} y={ROWS.samples + 11} className="regular fill-dim">
              samples
            </text>
            <text x={4} y={ROWS.output + 17}>
              filtered
            </text>
          </g>
        </svg>
        <span className="unseen" role="status">
          {spoken}
        </span>
      </div>
    </Savable>
  );
}
