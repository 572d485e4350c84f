import { type KeyboardEvent, type PointerEvent, useRef, useState } from "react";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Savable } from "../../../plots/Savable";
import { type Knot, moved } from "./knots";

interface Props {
  knots: readonly Knot[];
  onChange: (knots: Knot[]) => void;
}

const WIDTH = 800;
const HEIGHT = 240;
const EDGE = 14;

/** v(t) with knots that are dragged, or moved by the arrow keys (with Shift ten times as far). */
export function Drawing({ knots, onChange }: Props) {
  const scheme = useScheme();
  const svg = useRef<SVGSVGElement>(null);
  const [held, setHeld] = useState<number | null>(null);
  // While a knot is dragged the scales stand still, else it would run away from under the pointer.
  const [frame, setFrame] = useState<{ endS: number; peak: number } | null>(null);
  const endS = frame?.endS ?? (knots[knots.length - 1]?.timeS || 1) * 1.05;
  const peak = frame?.peak ?? Math.max(100, ...knots.map(({ pps }) => Math.abs(pps))) * 1.25;
  const below = frame !== null || knots.some(({ pps }) => pps < 0);
  const zero = below ? HEIGHT / 2 : HEIGHT - EDGE;
  const tall = zero - EDGE;
  const x = (timeS: number) => EDGE + (timeS / endS) * (WIDTH - 2 * EDGE);
  const y = (pps: number) => zero - (pps / peak) * tall;

  const drag = (event: PointerEvent<SVGSVGElement>) => {
    const box = svg.current?.getBoundingClientRect();
    if (held === null || !box) return;
    const timeS = ((((event.clientX - box.left) / box.width) * WIDTH - EDGE) / (WIDTH - 2 * EDGE)) * endS;
    const pps = ((zero - ((event.clientY - box.top) / box.height) * HEIGHT) / tall) * peak;
    onChange(moved(knots, held, timeS, pps));
  };
  const release = () => {
    setHeld(null);
    setFrame(null);
  };
  const step = (event: KeyboardEvent, index: number) => {
    const far = event.shiftKey ? 10 : 1;
    const ways: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    };
    const way = ways[event.key];
    const knot = knots[index];
    if (!way || !knot) return;
    event.preventDefault();
    onChange(moved(knots, index, knot.timeS + (way[0] * far * endS) / 200, knot.pps + (way[1] * far * peak) / 100));
  };

  const speeds = knots.map(({ pps }) => pps);
  const levels = [...new Set([Math.max(...speeds), Math.min(...speeds)])].filter((pps) => pps !== 0);
  const lastS = knots[knots.length - 1]?.timeS ?? 0;
  return (
    <Savable name="Velocity over time">
      {/* biome-ignore lint/a11y/useSemanticElements: a drawing is no fieldset */}
      <svg
        ref={svg}
        viewBox={`0 0 ${WIDTH} ${HEIGHT}`}
        className="block w-full"
        role="group"
        aria-label={`Velocity over ${compact(endS / 1.05, 4, "s")}, ${knots.length} knots`}
        onPointerMove={drag}
        onPointerUp={release}
        onPointerCancel={release}
        style={{ touchAction: "none" }}
      >
        <line x1={EDGE} x2={WIDTH - EDGE} y1={zero} y2={zero} stroke="currentColor" strokeOpacity={0.3} />
        {levels.map((pps) => (
          <line
            key={pps}
            x1={EDGE}
            x2={WIDTH - EDGE}
            y1={y(pps)}
            y2={y(pps)}
            stroke="currentColor"
            strokeOpacity={0.3}
            strokeDasharray="3 4"
          />
        ))}
        <polyline
          points={knots.map(({ timeS, pps }) => `${x(timeS)},${y(pps)}`).join(" ")}
          fill="none"
          stroke={colorOf("velocity", scheme)}
          strokeWidth={2}
        />
        {knots.map(({ timeS, pps }, index) => (
          <circle
            // biome-ignore lint/suspicious/noArrayIndexKey: a knot is its place in the row
            key={index}
            cx={x(timeS)}
            cy={y(pps)}
            r={held === index ? 9 : 7}
            fill={colorOf("velocity", scheme)}
            tabIndex={0}
            role="slider"
            aria-label={`Knot ${index + 1}`}
            aria-valuenow={Math.round(pps)}
            aria-valuetext={`${compact(pps, 4, "pps")} at ${compact(timeS, 4, "s")}`}
            style={{ cursor: "grab", pointerEvents: "auto" }}
            onPointerDown={(event) => {
              event.preventDefault();
              event.currentTarget.focus();
              svg.current?.setPointerCapture(event.pointerId);
              setFrame({ endS, peak });
              setHeld(index);
            }}
            onKeyDown={(event) => step(event, index)}
          />
        ))}
      </svg>
      {/* not within the drawing, whose letters would shrink with it */}
      {levels.map((pps) => (
        <span
          key={pps}
          className="hint"
          aria-hidden
          style={{
            position: "absolute",
            left: `${(100 * EDGE) / WIDTH}%`,
            bottom: `calc(18px + (100% - 18px) * ${1 - y(pps) / HEIGHT})`,
          }}
        >
          {compact(pps, 4, "pps")}
        </span>
      ))}
      <div className="hint relative" aria-hidden style={{ height: 18 }}>
        <span style={{ position: "absolute", left: `${(100 * x(0)) / WIDTH}%` }}>0 s</span>
        <span style={{ position: "absolute", right: `${100 - (100 * x(lastS)) / WIDTH}%` }}>
          {compact(lastS, 4, "s")}
        </span>
      </div>
    </Savable>
  );
}
