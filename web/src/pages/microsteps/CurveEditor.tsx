import { useElementSize } from "@mantine/hooks";
import { type KeyboardEvent, type PointerEvent, useRef, useState } from "react";
import { fixed } from "../../lib/format";
import { Savable } from "../../plots/Savable";
import classes from "./Microsteps.module.css";
import { clamp, ENTRIES, TOP, withEntry, withStroke } from "./table";

export type Tool = "drag" | "draw";

interface Props {
  values: readonly number[];
  /** what the chip holds, for comparison */
  before: readonly number[] | null;
  tool: Tool;
  /** a change within a gesture, named by its tag */
  onChange: (values: number[], tag: string) => void;
  onSettle: () => void;
}

const HEIGHT = 300;
const MARGIN = { left: 30, right: 10, top: 10, bottom: 22 };

/** The quarter wave: 64 points to drag or to draw through; with the keyboard one point at a time. */
export function CurveEditor({ values, before, tool, onChange, onSettle }: Props) {
  const { ref, width } = useElementSize<HTMLDivElement>();
  const [active, setActive] = useState(0);
  const points = useRef<(SVGGElement | null)[]>([]);
  const held = useRef<{ index: number; value: number } | null>(null);

  const inner = Math.max(100, width - MARGIN.left - MARGIN.right);
  const tall = HEIGHT - MARGIN.top - MARGIN.bottom;
  const x = (index: number) => MARGIN.left + (index / (ENTRIES - 1)) * inner;
  const y = (value: number) => MARGIN.top + (1 - value / TOP) * tall;

  function at(event: PointerEvent<SVGSVGElement>) {
    const box = event.currentTarget.getBoundingClientRect();
    const index = Math.round(((event.clientX - box.left - MARGIN.left) / inner) * (ENTRIES - 1));
    return {
      index: Math.min(ENTRIES - 1, Math.max(0, index)),
      value: clamp((1 - (event.clientY - box.top - MARGIN.top) / tall) * TOP),
    };
  }

  function onDown(event: PointerEvent<SVGSVGElement>) {
    if (event.button !== 0) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    const here = at(event);
    held.current = here;
    setActive(here.index);
    onChange(withEntry(values, here.index, here.value), tool === "draw" ? "stroke" : `point ${here.index}`);
    points.current[here.index]?.focus({ preventScroll: true });
    event.preventDefault();
  }

  function onMove(event: PointerEvent<SVGSVGElement>) {
    const from = held.current;
    if (!from) return;
    const here = at(event);
    if (tool === "draw") {
      onChange(withStroke(values, from, here), "stroke");
      held.current = here;
      setActive(here.index);
    } else if (here.value !== values[from.index]) {
      onChange(withEntry(values, from.index, here.value), `point ${from.index}`);
    }
  }

  function onUp() {
    if (!held.current) return;
    held.current = null;
    onSettle();
  }

  function onKey(event: KeyboardEvent, index: number) {
    const value = values[index] ?? 0;
    const go = { ArrowLeft: index - 1, ArrowRight: index + 1, Home: 0, End: ENTRIES - 1 }[event.key];
    if (go !== undefined) {
      const next = Math.min(ENTRIES - 1, Math.max(0, go));
      setActive(next);
      points.current[next]?.focus();
    } else {
      const step = event.shiftKey ? 5 : 1;
      const change = { ArrowUp: step, ArrowDown: -step, PageUp: 8, PageDown: -8 }[event.key];
      if (change === undefined) return;
      onChange(withEntry(values, index, value + change), `point ${index}`);
    }
    event.preventDefault();
  }

  const stairs = (table: readonly number[]) =>
    table.map((value, index) => `${index === 0 ? "M" : "L"}${x(index)},${y(value)}`).join("");
  const ideal = Array.from({ length: ENTRIES }, (_, index) => TOP * Math.sin((index / ENTRIES) * (Math.PI / 2)));

  return (
    <Savable low name="Quarter wave of the microstep table">
      <div ref={ref} className={classes.curve}>
        <svg
          width="100%"
          height={HEIGHT}
          data-tool={tool}
          onPointerDown={onDown}
          onPointerMove={onMove}
          onPointerUp={onUp}
          onPointerCancel={onUp}
        >
          <title>Quarter wave of the microstep table</title>
          {[0, 16, 32, 48, 63].map((value) => (
            <g key={`y${value}`}>
              <line className="grid-line faint" x1={MARGIN.left} x2={MARGIN.left + inner} y1={y(value)} y2={y(value)} />
              <text className="tick" x={MARGIN.left - 6} y={y(value)} textAnchor="end" dominantBaseline="central">
                {value}
              </text>
            </g>
          ))}
          {[0, 8, 16, 24, 32, 40, 48, 56, 63].map((index) => (
            <g key={`x${index}`}>
              <line className="grid-line faint" x1={x(index)} x2={x(index)} y1={MARGIN.top} y2={MARGIN.top + tall} />
              <text className="tick" x={x(index)} y={HEIGHT - 6} textAnchor="middle">
                {index}
              </text>
            </g>
          ))}
          <g>
            <path className="dashed fill-none stroke-grey stroke-1" d={stairs(ideal)} />
            {before && <path className="faint fill-none stroke-grey stroke-2" d={stairs(before)} />}
            <path fill="none" stroke="var(--accent)" strokeWidth={1.25} d={stairs(values)} />
          </g>
          {values.map((value, index) => (
            <g
              // biome-ignore lint/suspicious/noArrayIndexKey: an entry is its place in the table
              key={index}
              ref={(node) => {
                points.current[index] = node;
              }}
              className="point"
              role="slider"
              tabIndex={index === active ? 0 : -1}
              aria-label={`Entry ${index}`}
              aria-orientation="vertical"
              aria-valuemin={0}
              aria-valuemax={TOP}
              aria-valuenow={value}
              onKeyDown={(event) => onKey(event, index)}
              onFocus={() => setActive(index)}
              onBlur={onSettle}
            >
              <circle className="halo" cx={x(index)} cy={y(value)} r={7} />
              <circle className="fill-accent" cx={x(index)} cy={y(value)} r={index === active ? 4 : 2.6} />
            </g>
          ))}
        </svg>
        <p className="room flex gap-12 m-0 text-12">
          <span>
            entry <span className="num">{active}</span> = <span className="num">{values[active]}</span>
          </span>
          {before && (
            <span className="dim">
              chip <span className="num">{before[active]}</span>
            </span>
          )}
          <span className="dim">
            sine <span className="num">{fixed(ideal[active] ?? 0, 1)}</span>
          </span>
        </p>
      </div>
    </Savable>
  );
}
