import { useElementSize } from "@mantine/hooks";
import { type KeyboardEvent, type PointerEvent, useMemo, useRef, useState } from "react";
import type { Schemas } from "../../../api/client";
import { coordinate, fixed } from "../../../lib/format";
import { useFrame } from "../../../live/useFrame";
import { Savable } from "../../../plots/Savable";
import { withStroke } from "../table";
import classes from "./Mslut.module.css";
import type { Seen } from "./seen";
import { bent, clamp, currentAt, ENTRIES, entryAt, POSITIONS, pairOf, SINE, type Table, TOP, WIDTH_HUES } from "./wave";

export type Tool = "bend" | "point" | "draw";
export type View = "quarter" | "period";

interface Wave {
  values: readonly number[];
  mirror: number;
}

interface Props extends Wave {
  view: View;
  tool: Tool;
  /** of the wave, or of the nearest one while it is refused */
  segments: Table["segments"];
  refusals: readonly Schemas["MslutRefusal"][];
  nearest: Wave | null;
  /** what the chip holds, for comparison */
  before: Wave | null;
  beforeName: string;
  /** where the chip stands, and both currents there */
  live: { position: number; current_a: number; current_b: number } | null;
  /** what the chip showed while it turned */
  seen: Seen;
  onChange: (values: number[], tag: string) => void;
  onSettle: () => void;
}

const HEIGHT = { quarter: 300, period: 300 };
const STRIP = 104;
const MARGIN = { left: 38, right: 12, top: 20, bottom: 20 };
/** Ranges of the strip below, around zero [counts]. */
const RANGES = [2, 5, 10, 20, 50, 100, 250, 600];
const IDEAL: Wave = { values: SINE, mirror: -1 };

function stairs(points: readonly number[], x: (place: number) => number, y: (value: number) => number): string {
  return points
    .map((value, place) => `${place === 0 ? "M" : "L"}${coordinate(x(place), 1)},${coordinate(y(value), 1)}`)
    .join("");
}

/**
 * The wave, its segments as bands, the places where it cannot be encoded, and below it how far it is from a sine. With
 * the pointer it is bent, moved by single entries or drawn; with the keyboard one entry at a time.
 */
export function WaveEditor(props: Props) {
  const {
    values,
    mirror,
    view,
    tool,
    segments,
    refusals,
    nearest,
    before,
    beforeName,
    live,
    seen,
    onChange,
    onSettle,
  } = props;
  const { ref, width } = useElementSize<HTMLDivElement>();
  const [active, setActive] = useState(0);
  const handle = useRef<SVGGElement>(null);
  const held = useRef<{ index: number; value: number; base: readonly number[] } | null>(null);

  const places = view === "quarter" ? ENTRIES : POSITIONS;
  const [low, high] = view === "quarter" ? [0, 256] : [-256, 256];
  const height = HEIGHT[view];
  const inner = Math.max(100, width - MARGIN.left - MARGIN.right);
  const tall = height - MARGIN.top - MARGIN.bottom;
  const x = (place: number) => MARGIN.left + (place / (places - 1)) * inner;
  const y = (value: number) => MARGIN.top + ((high - Math.min(high, Math.max(low, value))) / (high - low)) * tall;
  const whole = (wave: Wave, ahead = 0) =>
    Array.from({ length: places }, (_, place) => currentAt(wave.values, wave.mirror, place + ahead));

  const design = { values, mirror };
  const dots = useRef<SVGPathElement>(null);
  const drawn = useRef("");
  useFrame(() => {
    const key = `${seen.revision} ${view} ${width}`;
    if (key === drawn.current || !dots.current) return;
    drawn.current = key;
    const places = seen.dots(view === "quarter", before?.mirror ?? mirror);
    // one sample at rest is the marker's, not a trace
    const path =
      places.length < 5
        ? ""
        : places.map(([place, value]) => `M${coordinate(x(place), 1)},${coordinate(y(value), 1)}h0`).join("");
    dots.current.setAttribute("d", path);
  });
  const strip = useMemo(() => {
    const ideal = Array.from({ length: places }, (_, place) => currentAt(SINE, -1, place));
    const apart = (wave: Wave | null) =>
      wave &&
      // half counts: the sine of the complement grid lies at -1/2, that of opposite halves at 0
      ideal.map((sine, place) => currentAt(wave.values, wave.mirror, place) - wave.mirror / 2 - (sine + 0.5));
    const lines = {
      design: apart({ values, mirror }) ?? [],
      nearest: apart(nearest),
      before: apart(before),
    };
    const most = [...lines.design, ...(lines.nearest ?? []), ...(lines.before ?? [])].reduce(
      (most, value) => Math.max(most, Math.abs(value)),
      1,
    );
    return { ...lines, range: RANGES.find((range) => range >= most) ?? 600 };
  }, [places, values, mirror, nearest, before]);
  const stripY = (value: number) =>
    20 + ((strip.range - Math.min(strip.range, Math.max(-strip.range, value))) / (2 * strip.range)) * (STRIP - 28);

  function at(event: PointerEvent<SVGSVGElement>) {
    const box = event.currentTarget.getBoundingClientRect();
    const place = Math.round(((event.clientX - box.left - MARGIN.left) / inner) * (places - 1));
    const { index, negative } = entryAt(Math.min(places - 1, Math.max(0, place)));
    const current = high - ((event.clientY - box.top - MARGIN.top) / tall) * (high - low);
    return { index, value: clamp(negative ? mirror - current : current) };
  }

  const withEntry = (base: readonly number[], index: number, value: number) =>
    tool === "bend" ? bent(base, index, value) : base.map((old, place) => (place === index ? clamp(value) : old));

  function onDown(event: PointerEvent<SVGSVGElement>) {
    if (event.button !== 0) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    const here = at(event);
    // a bend takes hold of the curve where it is; the others go where the pointer is
    const value = tool === "bend" ? (values[here.index] ?? 0) : here.value;
    held.current = { index: here.index, value: tool === "bend" ? here.value : value, base: values };
    setActive(here.index);
    if (tool !== "bend")
      onChange(withEntry(values, here.index, value), tool === "draw" ? "stroke" : `point ${here.index}`);
    handle.current?.focus({ preventScroll: true });
    event.preventDefault();
  }

  function onMove(event: PointerEvent<SVGSVGElement>) {
    const from = held.current;
    if (!from) return;
    const here = at(event);
    if (tool === "draw") {
      onChange(withStroke(values, from, here, clamp), "stroke");
      held.current = { ...here, base: values };
      setActive(here.index);
    } else if (tool === "bend") {
      const to = (from.base[from.index] ?? 0) + here.value - from.value;
      onChange(bent(from.base, from.index, to), `bend ${from.index}`);
    } else if (here.value !== values[from.index]) {
      onChange(withEntry(values, from.index, here.value), `point ${from.index}`);
    }
  }

  function onUp() {
    if (!held.current) return;
    held.current = null;
    onSettle();
  }

  function onKey(event: KeyboardEvent) {
    const pace = event.shiftKey ? 10 : 1;
    const go = { ArrowLeft: active - pace, ArrowRight: active + pace, Home: 0, End: ENTRIES - 1 }[event.key];
    const by = { ArrowUp: pace, ArrowDown: -pace, PageUp: 10, PageDown: -10 }[event.key];
    if (go !== undefined) setActive(Math.min(ENTRIES - 1, Math.max(0, go)));
    else if (by !== undefined) onChange(withEntry(values, active, (values[active] ?? 0) + by), `key ${active}`);
    else return;
    event.preventDefault();
  }

  const quarters = view === "quarter" ? [0] : [0, 1, 2, 3];
  const bands = quarters.flatMap((quarter) =>
    segments.map((segment) => {
      const [first, last] = [segment.first, segment.last + 1];
      const [from, to] =
        quarter % 2 === 0
          ? [quarter * ENTRIES + first, quarter * ENTRIES + last]
          : [(quarter + 1) * ENTRIES - last, (quarter + 1) * ENTRIES - first];
      return { key: `${quarter}-${first}`, from: x(from - 0.5), to: x(to - 0.5), segment, named: quarter === 0 };
    }),
  );
  const marks = refusals.filter((refusal) => refusal.reason !== "asymmetric");
  const yTicks = view === "quarter" ? [0, 64, 128, 192, 255] : [-255, -128, 0, 128, 255];
  const xTicks =
    view === "quarter" ? [0, 32, 64, 96, 128, 160, 192, 224, 255] : [0, 128, 256, 384, 512, 640, 768, 896, 1023];
  const value = values[active] ?? 0;

  return (
    <Savable low name="Wave of the microstep table">
      <div ref={ref} className={classes.wave}>
        <svg
          width="100%"
          height={height}
          data-tool={tool}
          onPointerDown={onDown}
          onPointerMove={onMove}
          onPointerUp={onUp}
          onPointerCancel={onUp}
        >
          <title>Wave of the microstep table with its segments</title>
          {bands.map(({ key, from, to, segment, named }) => (
            <g key={key}>
              <rect
                className={`${classes.band} ${WIDTH_HUES[segment.width] ?? ""}`}
                data-offered={nearest !== null || undefined}
                x={Math.max(MARGIN.left, from)}
                width={Math.max(0, Math.min(MARGIN.left + inner, to) - Math.max(MARGIN.left, from))}
                y={4}
                height={height - MARGIN.bottom - 4}
              />
              {named && to - from > 26 && (
                <text className="text-12 fill-text touchless" x={Math.max(MARGIN.left, from) + 4} y={15}>
                  {to - from > 64 ? `W${segment.width}: ${pairOf(segment.low)}` : `W${segment.width}`}
                </text>
              )}
            </g>
          ))}
          {yTicks.map((tick) => (
            <g key={`y${tick}`}>
              <line className="grid-line faint" x1={MARGIN.left} x2={MARGIN.left + inner} y1={y(tick)} y2={y(tick)} />
              <text className="tick" x={MARGIN.left - 6} y={y(tick)} textAnchor="end" dominantBaseline="central">
                {fixed(tick)}
              </text>
            </g>
          ))}
          {xTicks.map((tick) => (
            <g key={`x${tick}`}>
              <line className="grid-line faint" x1={x(tick)} x2={x(tick)} y1={MARGIN.top} y2={MARGIN.top + tall} />
              <text className="tick" x={x(tick)} y={height - 6} textAnchor="middle">
                {tick}
              </text>
            </g>
          ))}
          <path className="dashed fill-none stroke-grey stroke-1" d={stairs(whole(IDEAL), x, y)} />
          {before && <path className="faint fill-none stroke-grey stroke-2" d={stairs(whole(before), x, y)} />}
          {view === "period" && (
            <path
              fill="none"
              stroke="var(--orange)"
              strokeWidth={1.25}
              opacity={0.8}
              d={stairs(whole(design, ENTRIES), x, y)}
            />
          )}
          {nearest && <path fill="none" stroke="var(--violet)" strokeWidth={1.75} d={stairs(whole(nearest), x, y)} />}
          <path className="fill-none stroke-accent stroke-1-5" d={stairs(whole(design), x, y)} />
          <path
            ref={dots}
            fill="none"
            stroke="var(--mantine-color-text)"
            strokeWidth={2.5}
            strokeLinecap="round"
            opacity={0.75}
          />
          {marks.map((refusal, place) => (
            <g key={`${refusal.index} ${refusal.reason}`} className={classes.refusal}>
              <title>{`entry ${refusal.index}: ${refusal.detail}`}</title>
              <line
                className={classes.refusalLine}
                data-first={place === 0 || undefined}
                x1={x(refusal.index)}
                x2={x(refusal.index)}
                y1={MARGIN.top}
                y2={MARGIN.top + tall}
              />
              <path d={`M${x(refusal.index)},${MARGIN.top + tall} l-4,7 h8 Z`} />
              <circle cx={x(refusal.index)} cy={y(values[refusal.index] ?? 0)} r={place === 0 ? 5 : 3} />
            </g>
          ))}
          {live && (
            <g className={classes.liveMark}>
              {view === "period" ? (
                <>
                  <line x1={x(live.position)} x2={x(live.position)} y1={MARGIN.top} y2={MARGIN.top + tall} />
                  <circle data-phase="a" cx={x(live.position)} cy={y(live.current_a)} r={4} />
                  <circle data-phase="b" cx={x(live.position)} cy={y(live.current_b)} r={4} />
                </>
              ) : (
                <line
                  x1={x(entryAt(live.position).index)}
                  x2={x(entryAt(live.position).index)}
                  y1={MARGIN.top}
                  y2={MARGIN.top + tall}
                />
              )}
            </g>
          )}
          <g
            ref={handle}
            className="point"
            role="slider"
            tabIndex={0}
            aria-label={`Entry ${active}`}
            aria-orientation="vertical"
            aria-valuemin={0}
            aria-valuemax={TOP}
            aria-valuenow={value}
            onKeyDown={onKey}
            onBlur={onSettle}
          >
            <circle className="halo" cx={x(active)} cy={y(value)} r={8} />
            <circle className="fill-accent" cx={x(active)} cy={y(value)} r={3.5} />
          </g>
        </svg>
        <svg width="100%" height={STRIP} aria-hidden="true">
          {[strip.range, 0, -strip.range].map((tick) => (
            <g key={tick}>
              <line
                className="grid-line faint"
                x1={MARGIN.left}
                x2={MARGIN.left + inner}
                y1={stripY(tick)}
                y2={stripY(tick)}
              />
              <text className="tick" x={MARGIN.left - 6} y={stripY(tick)} textAnchor="end" dominantBaseline="central">
                {tick > 0 ? `+${tick}` : fixed(tick)}
              </text>
            </g>
          ))}
          <text className="tick" x={MARGIN.left} y={10}>
            distance from a sine of 248, counts
          </text>
          {strip.before && (
            <path className="faint fill-none stroke-grey stroke-2" d={stairs(strip.before, x, stripY)} />
          )}
          {strip.nearest && (
            <path fill="none" stroke="var(--violet)" strokeWidth={1.75} d={stairs(strip.nearest, x, stripY)} />
          )}
          <path className="fill-none stroke-accent stroke-1-5" d={stairs(strip.design, x, stripY)} />
        </svg>
        <p className={`${classes.readout} room lines-12 m-0 text-12`}>
          <span>
            entry <span className="num">{active}</span> = <span className="num">{fixed(value)}</span>
          </span>
          <span className="dim">
            {active === 0 ? "zero crossing" : "from the one before"}{" "}
            <span className="num">{signed(active === 0 ? 2 * value - mirror : value - (values[active - 1] ?? 0))}</span>
          </span>
          {before && (
            <span className="dim">
              {beforeName} <span className="num">{before.values[active]}</span>
            </span>
          )}
          <span className="dim">
            from the sine <span className="num">{signed(strip.design[active] ?? 0, 1)}</span>
          </span>
        </p>
      </div>
    </Savable>
  );
}

function signed(value: number, decimals = 0): string {
  return `${value > 0 ? "+" : ""}${fixed(value, decimals)}`;
}
