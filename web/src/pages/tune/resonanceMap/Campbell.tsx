import { useId, useState } from "react";
import { compact } from "../../../lib/format";
import { Savable } from "../../../plots/Savable";
import classes from "./campbell.module.css";
import { type Campbell as Campbells, CIVIDIS, colourOf, type Dot, saidOf, walked } from "./dots";

const WIDTH = 560;
const HEIGHT = 300;
const LEFT = 52;
const BOTTOM = 40;
const RADIUS = { least: 3, greatest: 9 };

const across = (share: number) => LEFT + share * (WIDTH - LEFT);
const up = (share: number) => (HEIGHT - BOTTOM) * (1 - share);

/** A Campbell plot: each order's frequency over the speed; dots are larger and lighter the more it vibrates there. */
export function Campbell({ plot, summary }: { plot: Campbells; summary: string }) {
  const help = useId();
  const [picked, setPicked] = useState<Dot | null>(null);
  const shown = plot.dots.find((dot) => dot.speed === picked?.speed && dot.order === picked.order) ?? null;
  return (
    <Savable name="Campbell plot">
      <figure className={classes.campbell}>
        <div
          role="img"
          aria-label={`Campbell plot: frequency and amplitude of each order over the speed. ${summary}`}
          aria-describedby={help}
          // biome-ignore lint/a11y/noNoninteractiveTabindex: arrow keys go from dot to dot, which the line below reads out
          tabIndex={0}
          className={classes.plot}
          onKeyDown={(event) => {
            if (!event.key.startsWith("Arrow")) return;
            event.preventDefault();
            setPicked(walked(plot.dots, shown, event.key));
          }}
        >
          <svg viewBox={`0 0 ${WIDTH} ${HEIGHT}`} aria-hidden="true" focusable="false">
            {plot.speeds.map(({ at, label }) => (
              <g key={label}>
                <line x1={across(at)} x2={across(at)} y1={0} y2={up(0)} className={classes.grid} />
                <text x={across(at)} y={HEIGHT - BOTTOM + 16} textAnchor="middle">
                  {label}
                </text>
              </g>
            ))}
            {plot.frequencies.map(({ at, label }) => (
              <g key={label}>
                <line x1={LEFT} x2={WIDTH} y1={up(at)} y2={up(at)} className={classes.grid} />
                <text x={LEFT - 6} y={up(at) + 4} textAnchor="end">
                  {label}
                </text>
              </g>
            ))}
            <text x={(LEFT + WIDTH) / 2} y={HEIGHT - 6} textAnchor="middle">
              speed [turns/s]
            </text>
            <text transform={`translate(12 ${up(0.5)}) rotate(-90)`} textAnchor="middle">
              frequency [Hz]
            </text>
            {plot.resonance !== null && (
              <line
                x1={LEFT}
                x2={WIDTH}
                y1={up(plot.resonance)}
                y2={up(plot.resonance)}
                className={classes.resonance}
                data-testid="resonance"
              />
            )}
            {plot.dots.map((dot) => (
              <circle
                key={`${dot.speed} ${dot.order}`}
                cx={across(dot.x)}
                cy={up(dot.y)}
                r={RADIUS.least + dot.level * (RADIUS.greatest - RADIUS.least)}
                fill={colourOf(dot)}
                className={dot === shown ? classes.picked : classes.dot}
                onPointerEnter={() => setPicked(dot)}
                onPointerDown={() => setPicked(dot)}
              />
            ))}
          </svg>
        </div>
        <p id={help} className="unseen">
          Arrow keys go from dot to dot.
        </p>
        <output className={classes.said} aria-live="polite">
          {shown ? saidOf(shown) : "Point at a dot, or go from dot to dot with the arrow keys."}
        </output>
        <figcaption className={classes.legend}>
          <span>Amplitude, electrical:</span>
          {CIVIDIS.map((colour, index) => (
            <span key={colour}>
              <i style={{ background: colour }} /> to {compact(plot.greatest * ((index + 1) / CIVIDIS.length) ** 2, 2)}°
            </span>
          ))}
          {plot.resonance !== null && (
            <span>
              <i className={classes.line} /> resonance
            </span>
          )}
        </figcaption>
      </figure>
    </Savable>
  );
}
