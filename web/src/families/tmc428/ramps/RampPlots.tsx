import { Center, SegmentedControl } from "@mantine/core";
import { useMemo, useRef, useState } from "react";
import type { Schemas } from "../../../api/client";
import { Card } from "../../../lib/Card";
import { compact, duration, withUnit } from "../../../lib/format";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import { QuantityField } from "../../../lib/QuantityField";
import { type AxisScale, fromSteps } from "../../../lib/units";
import type { Calculation } from "../../../lib/useCalc";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { PlotHandle } from "../../../plots/types";
import { type Band, usePlotBands } from "../../../plots/usePlotBands";
import type { RampMode } from "./design";
import classes from "./Ramps.module.css";

export type Ramp = Schemas["RampResult"];

interface Props {
  calculation: Calculation<Ramp>;
  /** why there is no ramp to calculate; null where there is one */
  impossible: string | null;
  mode: RampMode;
  onMode: (mode: RampMode) => void;
  distance: number;
  onDistance: (steps: number) => void;
  scale: AxisScale;
  units: { velocity: string; acceleration: string };
}

const GROUP = "ramp";

/** Alternating greys name no meaning; what goes beyond the plan (settling, reversal) is warm. */
export function phaseBands(phases: Ramp["phases"], scheme: "light" | "dark", named: boolean): Band[] {
  const grey = scheme === "light" ? "rgba(15, 23, 42, 0.05)" : "rgba(255, 255, 255, 0.055)";
  const none = "rgba(0, 0, 0, 0)";
  const warm = scheme === "light" ? "rgba(184, 116, 0, 0.16)" : "rgba(230, 159, 0, 0.18)";
  const ink = scheme === "light" ? "#4b5563" : "#a9b1bb";
  return phases.map((phase, index) => ({
    from: phase.start_s,
    to: phase.end_s,
    color: phase.name === "settling" || phase.name === "reversal" ? warm : index % 2 === 0 ? grey : none,
    ...(named ? { label: phase.name, labelColor: ink } : {}),
  }));
}

function Track(props: {
  label: string;
  color: string;
  unit: string;
  time: readonly number[];
  values: readonly number[];
  bands: readonly Band[];
  height: number;
  last?: boolean;
}) {
  const handle = useRef<PlotHandle>(null);
  usePlotBands(handle, props.bands);
  const data = useMemo(() => [props.time, props.values] as const, [props.time, props.values]);
  const end = props.time[props.time.length - 1] ?? 1;
  return (
    <Plot
      handle={handle}
      label={`${props.label} over time`}
      series={[{ label: props.label, color: props.color, unit: props.unit, width: 1.5 }]}
      data={data}
      height={props.height}
      group={GROUP}
      legend
      limit={[0, end]}
      x={props.last ? { label: "time", unit: "s" } : { axis: false }}
      scales={{ y: { include: [0] } }}
    />
  );
}

/** The whole ramp as the chip will make it, step by step: position, velocity, acceleration, phases. */
export function RampPlots(props: Props) {
  const { calculation, impossible, mode, onMode, distance, onDistance, scale, units } = props;
  const { result, stale, error, retry } = calculation;
  const scheme = useScheme();
  const [unit, setUnit] = useState("microsteps");
  const known = units.velocity;
  const acceleration = units.acceleration;

  const columns = useMemo(() => {
    if (!result) return null;
    return {
      position: result.position.map((value) => fromSteps(value, unit, scale, "position")),
      velocity: result.velocity_pps.map((value) => fromSteps(value, known, scale, "velocity")),
      acceleration: result.acceleration_pps2.map((value) => fromSteps(value, acceleration, scale, "acceleration")),
    };
  }, [result, unit, known, acceleration, scale]);

  const peak = result ? result.velocity_pps.reduce((most, value) => Math.max(most, Math.abs(value)), 0) : null;
  const shown = impossible === null && result && columns;

  return (
    <Card
      title="Ramp"
      note={
        <span className={stale ? "stale" : undefined}>
          {shown ? (
            <span className="num">
              {duration(result.duration_s)} · peak {withUnit(fromSteps(peak ?? 0, known, scale, "velocity"), known)}
              {mode === "velocity" ? "" : ` · overshoot ${compact(result.overshoot_steps)} µsteps`}
            </span>
          ) : (
            ""
          )}
        </span>
      }
      actions={
        <>
          <SegmentedControl
            aria-label="Ramp mode"
            value={mode}
            onChange={(value) => onMode(value as RampMode)}
            data={["ramp", "soft", "velocity"]}
          />
          <div className={`${classes.distance} row gap-6`}>
            <span className="hint" aria-hidden>
              distance
            </span>
            <QuantityField
              label="Distance"
              motion="position"
              scale={scale}
              value={distance}
              min={-8388607}
              max={8388607}
              onChange={(steps) => onDistance(Math.round(steps))}
              unit={unit}
              onUnit={setUnit}
            />
          </div>
        </>
      }
    >
      {impossible !== null ? (
        <Center h={420} className="stack gap-6 dim text-13 centered">
          <strong className="m-0 caution text-12">No ramp to show</strong>
          <span>{impossible}</span>
        </Center>
      ) : (
        <div style={{ minHeight: 420 }}>
          {error !== null && <ProblemAlert error={error} doing="Calculating the ramp" retry={retry} />}
          {shown ? (
            <div className={stale ? "stale" : undefined} aria-busy={stale}>
              <Track
                label="Position"
                color={colorOf("position", scheme)}
                unit={unit}
                time={result.time_s}
                values={columns.position}
                bands={phaseBands(result.phases, scheme, true)}
                height={132}
              />
              <Track
                label="Velocity"
                color={colorOf("velocity", scheme)}
                unit={known}
                time={result.time_s}
                values={columns.velocity}
                bands={phaseBands(result.phases, scheme, false)}
                height={132}
              />
              <Track
                label="Acceleration"
                color={colorOf("acceleration", scheme)}
                unit={acceleration}
                time={result.time_s}
                values={columns.acceleration}
                bands={phaseBands(result.phases, scheme, false)}
                height={148}
                last
              />
              <ol className="list under-plot lines-12 hint mt-4" aria-label="Phases">
                {result.phases.map((phase) => (
                  <li key={`${phase.name}${phase.start_s}`}>
                    {phase.name} <span className="num ink">{duration(phase.end_s - phase.start_s)}</span>
                  </li>
                ))}
              </ol>
              {result.warnings.map((warning) => (
                <p key={warning} className="m-0 caution text-12">
                  {warning}
                </p>
              ))}
            </div>
          ) : (
            error === null && (
              <Center mih={160} className="dim text-13">
                calculating the ramp
              </Center>
            )
          )}
        </div>
      )}
    </Card>
  );
}
