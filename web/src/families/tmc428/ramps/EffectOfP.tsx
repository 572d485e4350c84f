import { Center } from "@mantine/core";
import { useEffect, useMemo, useRef } from "react";
import { problemOf } from "../../../api/client";
import { Card } from "../../../lib/Card";
import { compact, duration, fixed } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import type { AxisScale } from "../../../lib/units";
import { fromSteps } from "../../../lib/units";
import type { Calculation } from "../../../lib/useCalc";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { roundRange } from "../../../plots/ranges";
import type { Overlay, PlotHandle } from "../../../plots/types";
import type { Pair } from "./design";
import type { Ramp } from "./RampPlots";
import classes from "./Ramps.module.css";

export interface Variant {
  id: "chosen" | "large" | "small";
  label: string;
  pair: Pair | null;
  calculation: Calculation<Ramp>;
}

interface Props {
  variants: readonly Variant[];
  /** no pair represents the p of this design */
  noPair: boolean;
  distance: number;
  scale: AxisScale;
  unit: string;
}

const DASH: Record<Variant["id"], number[] | undefined> = { chosen: undefined, large: [7, 3], small: [2, 3] };

/** When a ramp is within `part` of its way of the target, as the moment from which the approach is looked at. */
export function approachStart(ramp: Ramp, distance: number, part: number): number {
  const limit = Math.abs(distance) * part;
  const row = ramp.position.findIndex((position) => Math.abs(distance - position) <= limit);
  return ramp.time_s[Math.max(0, row)] ?? 0;
}

type Ramps = Record<Variant["id"], Ramp | null>;

function rampOf(variants: readonly Variant[], id: Variant["id"]): Ramp | null {
  const variant = variants.find((entry) => entry.id === id);
  return variant?.pair && variant.calculation.error === null ? (variant.calculation.result ?? null) : null;
}

function shadesOf(scheme: "light" | "dark"): Record<Variant["id"], string> {
  return {
    chosen: colorOf("position", scheme),
    large: colorOf("predicted_position", scheme),
    small: colorOf("residual", scheme),
  };
}

function draw(ramps: Ramps, distance: number, unit: string, scale: AxisScale, scheme: "light" | "dark") {
  const { chosen } = ramps;
  if (!chosen) return null;
  const shade = shadesOf(scheme);
  const there = Object.values(ramps).filter((ramp) => ramp !== null);
  const toGo = (ramp: Ramp) => ramp.position.map((position) => position - distance);
  const speed = (ramp: Ramp) => ramp.velocity_pps.map((value) => fromSteps(value, unit, scale, "velocity"));
  const overlays = (column: (ramp: Ramp) => number[]): Overlay[] =>
    (["large", "small"] as const).flatMap((id) => {
      const ramp = ramps[id];
      return ramp ? [{ x: ramp.time_s, y: column(ramp), color: shade[id], width: 1.5, dash: DASH[id] ?? [] }] : [];
    });
  const speeds = there.flatMap(speed);
  return {
    from: Math.min(...there.map((ramp) => approachStart(ramp, distance, 0.5))),
    to: Math.max(...there.map((ramp) => ramp.duration_s)),
    late: approachStart(chosen, distance, 0.06),
    over: Math.max(0, ...there.map((ramp) => ramp.overshoot_steps)),
    toGo: [chosen.time_s, toGo(chosen)] as const,
    speed: [chosen.time_s, speed(chosen)] as const,
    toGoOverlays: overlays(toGo),
    speedOverlays: overlays(speed),
    speedRange: roundRange(
      speeds.reduce((low, value) => Math.min(low, value), 0),
      speeds.reduce((high, value) => Math.max(high, value), 0),
    ),
  };
}

/** What each p does on the last stretch: the chosen pair, one that is too large, one that is too small. */
export function EffectOfP({ variants, noPair, distance, scale, unit }: Props) {
  const scheme = useScheme();
  const shade = shadesOf(scheme);
  const chosen = rampOf(variants, "chosen");
  const large = rampOf(variants, "large");
  const small = rampOf(variants, "small");
  const stale = variants.some(
    (variant) => variant.pair !== null && variant.calculation.stale && variant.calculation.error === null,
  );
  const drawn = useMemo(
    () => draw({ chosen, large, small }, distance, unit, scale, scheme),
    [chosen, large, small, distance, unit, scale, scheme],
  );
  // Only the approach is looked at; the gestures of the plot still reach the rest.
  const braking = useRef<PlotHandle>(null);
  const landing = useRef<PlotHandle>(null);
  useEffect(() => {
    if (!drawn) return;
    // in the next frame: by then the plots have taken their new data, which shows all of it
    const request = requestAnimationFrame(() => {
      braking.current?.setWindow(drawn.from, drawn.to);
      landing.current?.setWindow(drawn.late, drawn.to);
    });
    return () => cancelAnimationFrame(request);
  }, [drawn]);

  return (
    <Card title="What p does at the target" note="the last stretch of a move, exact">
      <ul className={`${classes.variants} list grid gap-2 mb-8 text-12`}>
        {variants.map((variant) => {
          const { result, error } = variant.calculation;
          return (
            <li key={variant.id}>
              <svg width="26" height="8" aria-hidden="true">
                <line
                  x1="1"
                  x2="25"
                  y1="4"
                  y2="4"
                  stroke={shade[variant.id]}
                  strokeWidth="2"
                  strokeDasharray={DASH[variant.id]?.join(" ")}
                />
              </svg>
              <span>{variant.label}</span>
              <span className="num hint breaks">
                {variant.pair === null
                  ? noPair || variants[0]?.pair
                    ? "no pair represents it"
                    : ""
                  : error !== null
                    ? problemOf(error).detail
                    : result
                      ? `overshoot ${fixed(result.overshoot_steps)} µsteps, ${duration(result.duration_s)}`
                      : ""}
              </span>
            </li>
          );
        })}
      </ul>
      {drawn ? (
        <div className={`columns ${stale ? "stale" : ""}`} aria-busy={stale}>
          <Plot
            handle={braking}
            label="Velocity while braking"
            summary={`With the chosen pair the move takes ${duration(chosen?.duration_s)}`}
            series={[{ label: "Velocity", color: shade.chosen, unit, width: 1.5 }]}
            data={drawn.speed}
            overlays={drawn.speedOverlays}
            x={{ label: "time", unit: "s" }}
            scales={{ y: { range: drawn.speedRange } }}
            legend
            height={200}
          />
          <Plot
            handle={landing}
            label="Distance from the target, overshoot zoomed"
            summary={`Largest overshoot ${compact(drawn.over)} microsteps`}
            series={[{ label: "Beyond target", color: shade.chosen, unit: "microsteps", width: 1.5 }]}
            data={drawn.toGo}
            overlays={drawn.toGoOverlays}
            x={{ label: "time", unit: "s" }}
            scales={{ y: { range: zoomOn(drawn.over) } }}
            legend
            height={200}
          />
        </div>
      ) : (
        <Center h={200} className="dim text-13">
          {variants[0]?.pair === null ? "A pair is needed first." : ""}
        </Center>
      )}
    </Card>
  );
}

/** The y range around the target: the overshoot with some air, at least a few steps, and as much before it. */
export function zoomOn(overshoot: number): [number, number] {
  const beyond = Math.max(4, Math.ceil(overshoot * 1.25));
  return [-beyond, beyond];
}
