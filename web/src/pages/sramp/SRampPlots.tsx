import { SegmentedControl } from "@mantine/core";
import { useMemo } from "react";
import { compact, withUnit } from "../../lib/format";
import { colorOf } from "../../lib/palette";
import type { Answer, Kind } from "../../lib/ramp/answer";
import type { Reach } from "../../lib/ramp/HandleLayer";
import { marginMark } from "../../lib/ramp/motor";
import { type LiveOverlays, type PlotHandles, RampView, type TrackOf } from "../../lib/ramp/RampView";
import { factor, time, type Units } from "../../lib/ramp/scales";
import { NO_SCALE, TORQUE_SCALE, torqueLines, UNSEEN_SCALE } from "../../lib/ramp/torque";
import type { Following } from "../../lib/ramp/useFollow";
import type { AxisScale } from "../../lib/units";
import { usePhone } from "../../lib/usePhone";
import { useScheme } from "../../lib/useScheme";
import { type Design, KIND, type Mode, type Options, type Parameter, used } from "./design";
import { handlesOf, shownHandles } from "./handles";
import { HUES, stretches } from "./phases";
import { corners } from "./rivals";

interface Props {
  calculation: Following<Answer>;
  design: Design;
  options: Options;
  onOptions: (change: Partial<Options>) => void;
  distance: number;
  onDistance: (steps: number) => void;
  onChange: (parameter: Parameter, value: number) => void;
  reach: (parameter: Parameter) => Reach;
  scale: AxisScale;
  units: Units;
  onUnits: (key: string) => void;
  live: LiveOverlays;
  plots: PlotHandles;
  held: boolean;
  onHold: (held: boolean) => void;
  seen: boolean;
}

/** Velocity, acceleration and jerk of an S-ramp, with the trapezoid of the same limits under it. */
export function SRampPlots(props: Props) {
  const { calculation, design, options, onOptions, distance, scale, units } = props;
  const { result } = calculation;
  const scheme = useScheme();
  const phone = usePhone();
  const way = distance < 0 ? -1 : 1;

  const factors = useMemo(
    () => ({
      velocity: factor("velocity", units, scale),
      acceleration: factor("acceleration", units, scale),
      jerk: factor("jerk", units, scale),
    }),
    [units, scale],
  );
  const torque = useMemo(() => (result?.torque ? torqueLines(result.torque, scheme) : null), [result, scheme]);
  const columns = useMemo(() => {
    if (!result) return null;
    const by = (values: readonly number[], divisor: number) => values.map((value) => value / divisor);
    return {
      velocity: [result.time_s, by(result.velocity_pps, factors.velocity)] as const,
      acceleration: [
        result.time_s,
        by(result.acceleration_pps2, factors.acceleration),
        ...(torque ? torque.columns : []),
      ] as const,
      jerk: [result.time_s, by(result.jerk_pps3, factors.jerk)] as const,
    };
  }, [result, factors, torque]);
  const shown = useMemo(() => (result ? stretches(result.phases, options.shape) : []), [result, options.shape]);
  const handles = useMemo(
    () => (result ? handlesOf(design, shownHandles(used(options), options), shown, result.duration_s, way) : []),
    [design, options, shown, result, way],
  );
  // the trapezoid of the same limits lies under the velocity, what the chip does over it
  const trapezoid = result?.rivals.find((rival) => rival.name === "trapezoid");
  const ghosts = useMemo(() => {
    if (!trapezoid) return [];
    const { x, y } = corners(trapezoid, way);
    const color = scheme === "light" ? "#8a8f98" : "#7b828c";
    return [{ x, y: y.map((value) => value / factors.velocity), color, dash: [4, 4], aside: true }];
  }, [trapezoid, way, factors, scheme]);

  const tracks: TrackOf[] = [];
  if (columns && result) {
    const track = (kind: "velocity" | "acceleration" | "jerk", label: string, height: number) => ({
      kind,
      label,
      height,
      data: columns[kind],
      color: colorOf(kind === "jerk" ? "residual" : kind, scheme),
      ...(torque ? { right: phone ? UNSEEN_SCALE : kind === "acceleration" ? TORQUE_SCALE : NO_SCALE } : {}),
    });
    tracks.push({ ...track("velocity", "Velocity", phone ? 170 : 190), ghosts });
    if (options.shape !== "hold")
      tracks.push({
        ...track("acceleration", "Acceleration", phone ? (torque ? 200 : 160) : 172),
        symmetric: true,
        more: torque?.series ?? [],
        marks: marginMark(result),
      });
    if (options.shape === "s")
      tracks.push({ ...track("jerk", "Jerk", phone ? 170 : 188), symmetric: true, stepped: true });
  }
  const peak = result ? Math.max(...result.limits.filter((limit) => limit.name === "VMAX").map(({ peak }) => peak)) : 0;

  return (
    <RampView
      group="sramp"
      calculation={calculation}
      tracks={tracks}
      stretches={shown}
      hues={HUES}
      handles={handles}
      kindOf={(parameter): Kind => KIND[parameter]}
      onChange={props.onChange}
      reach={props.reach}
      distance={distance}
      onDistance={props.onDistance}
      scale={scale}
      units={units}
      onUnits={props.onUnits}
      live={props.live}
      plots={props.plots}
      held={props.held}
      onHold={props.onHold}
      seen={props.seen}
      note={
        result && (
          <>
            {time(result.duration_s)} · peak {withUnit(peak / factors.velocity, units.velocity)}
            {options.mode === "position" && ` · overshoot ${compact(result.overshoot_steps)} µsteps`}
          </>
        )
      }
      choice={
        <SegmentedControl
          size="xs"
          aria-label="Ramp mode"
          value={options.mode}
          onChange={(mode) => onOptions({ mode: mode as Mode })}
          data={[
            { value: "position", label: "positioning" },
            { value: "velocity", label: "velocity" },
          ]}
        />
      }
      keys={trapezoid ? [{ line: "trapezoid", text: "trapezoid of the same limits" }] : []}
    />
  );
}
