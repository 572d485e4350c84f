import { SegmentedControl } from "@mantine/core";
import { useMemo } from "react";
import { withUnit } from "../../lib/format";
import { colorOf } from "../../lib/palette";
import type { Answer } from "../../lib/ramp/answer";
import type { Reach } from "../../lib/ramp/HandleLayer";
import { marginMark } from "../../lib/ramp/motor";
import { type LiveOverlays, type PlotHandles, RampView, type TrackOf } from "../../lib/ramp/RampView";
import { factor, time, type Units } from "../../lib/ramp/scales";
import { NO_SCALE, TORQUE_SCALE, torqueLines, UNSEEN_SCALE } from "../../lib/ramp/torque";
import type { Following } from "../../lib/ramp/useFollow";
import type { AxisScale } from "../../lib/units";
import { usePhone } from "../../lib/usePhone";
import { useScheme } from "../../lib/useScheme";
import type { Overlay } from "../../plots/types";
import { type Design, type Drawn, KIND, type Mode } from "./design";
import { handlesOf } from "./handles";
import { HUES, stretches } from "./phases";

/** Another ramp under this one. */
export interface Ghost {
  line: "trapezoid" | "earlier";
  text: string;
  answer: Answer;
}

interface Props {
  calculation: Following<Answer>;
  design: Design;
  mode: Mode;
  onMode: (mode: Mode) => void;
  distance: number;
  onDistance: (steps: number) => void;
  onChange: (parameter: Drawn, value: number) => void;
  reach: (parameter: Drawn) => Reach;
  scale: AxisScale;
  units: Units;
  onUnits: (key: string) => void;
  live: LiveOverlays;
  plots: PlotHandles;
  held: boolean;
  onHold: (held: boolean) => void;
  seen: boolean;
  ghosts: readonly Ghost[];
}

const INK: Record<Ghost["line"], { light: string; dark: string; dash?: number[] }> = {
  trapezoid: { light: "#8a8f98", dark: "#7b828c", dash: [4, 4] },
  earlier: { light: "#b5a5e3", dark: "#6f62a8" },
};
/** A rival that takes much longer would leave no room for the ramp. */
const MOST_LONGER = 1.6;

/** Position, velocity and acceleration of a SixPoint ramp, with its rivals under it. */
export function SixPointPlots(props: Props) {
  const { calculation, design, mode, distance, scale, units, ghosts } = props;
  const { result } = calculation;
  const scheme = useScheme();
  const phone = usePhone();
  const way = distance < 0 ? -1 : 1;

  const factors = useMemo(
    () => ({
      position: factor("position", units, scale),
      velocity: factor("velocity", units, scale),
      acceleration: factor("acceleration", units, scale),
    }),
    [units, scale],
  );
  const torque = useMemo(() => (result?.torque ? torqueLines(result.torque, scheme) : null), [result, scheme]);
  const columns = useMemo(() => {
    if (!result) return null;
    const by = (values: readonly number[], divisor: number) => values.map((value) => value / divisor);
    return {
      position: [result.time_s, by(result.position, factors.position)] as const,
      velocity: [result.time_s, by(result.velocity_pps, factors.velocity)] as const,
      acceleration: [
        result.time_s,
        by(result.acceleration_pps2, factors.acceleration),
        ...(torque ? torque.columns : []),
      ] as const,
    };
  }, [result, factors, torque]);
  const shown = useMemo(() => (result ? stretches(result.phases, mode) : []), [result, mode]);
  const handles = useMemo(
    () => (result ? handlesOf(design, mode, shown, result.duration_s, way) : []),
    [design, mode, shown, result, way],
  );
  const under = useMemo(() => {
    const drawn = (values: (answer: Answer) => readonly number[], divisor: number): Overlay[] =>
      ghosts.map(({ line, answer }) => {
        const { dash, ...ink } = INK[line];
        const y = values(answer).map((value) => value / divisor);
        return { x: answer.time_s, y, color: ink[scheme], ...(dash ? { dash } : {}), width: 1.5, aside: true };
      });
    return {
      position: drawn((answer) => answer.position, factors.position),
      velocity: drawn((answer) => answer.velocity_pps, factors.velocity),
      acceleration: drawn((answer) => answer.acceleration_pps2, factors.acceleration),
    };
  }, [ghosts, factors, scheme]);

  const tracks: TrackOf[] = [];
  if (columns && result) {
    const track = (kind: "position" | "velocity" | "acceleration", label: string, height: number) => ({
      kind,
      label,
      height,
      data: columns[kind],
      color: colorOf(kind, scheme),
      ghosts: under[kind],
      ...(torque ? { right: phone ? UNSEEN_SCALE : kind === "acceleration" ? TORQUE_SCALE : NO_SCALE } : {}),
    });
    tracks.push(
      { ...track("velocity", "Velocity", phone ? 180 : 200) },
      {
        ...track("acceleration", "Acceleration", phone ? (torque ? 200 : 170) : 190),
        symmetric: true,
        more: torque?.series ?? [],
        marks: marginMark(result),
      },
      { ...track("position", "Position", phone ? 130 : 150) },
    );
  }
  const peak = result?.velocity_pps.reduce((most, value) => Math.max(most, Math.abs(value)), 0) ?? 0;
  const longest = Math.max(0, ...ghosts.map(({ answer }) => answer.duration_s));

  return (
    <RampView
      group="sixpoint"
      calculation={calculation}
      tracks={tracks}
      stretches={shown}
      hues={HUES}
      handles={handles}
      kindOf={(parameter) => KIND[parameter]}
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
      until={Math.min(longest, (result?.duration_s ?? 0) * MOST_LONGER)}
      note={
        result && (
          <>
            {time(result.duration_s)} · peak {withUnit(peak / factors.velocity, units.velocity)}
          </>
        )
      }
      choice={
        <SegmentedControl
          size="xs"
          aria-label="Ramp mode"
          value={mode}
          onChange={(next) => props.onMode(next as Mode)}
          data={[
            { value: "position", label: "positioning" },
            { value: "velocity", label: "velocity" },
          ]}
        />
      }
      keys={ghosts.map(({ line, text }) => ({ line, text }))}
    />
  );
}
