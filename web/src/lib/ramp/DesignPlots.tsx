import { SegmentedControl } from "@mantine/core";
import { useMemo } from "react";
import type { Overlay } from "../../plots/types";
import { optionsOf } from "../choices";
import { withUnit } from "../format";
import { colorOf } from "../palette";
import type { Following } from "../useFollow";
import { usePhone } from "../usePhone";
import { useScheme } from "../useScheme";
import type { Answer, Kind } from "./answer";
import type { Reach } from "./HandleLayer";
import type { Handle } from "./handles";
import { marginMark } from "./motor";
import type { Hues, Stretch } from "./phases";
import { RampView, type TrackOf } from "./RampView";
import { factor, time } from "./scales";
import { NO_SCALE, TORQUE_SCALE, torqueLines, UNSEEN_SCALE } from "./torque";
import type { AnyDesigner } from "./useDesigner";

export type Mode = "position" | "velocity";

/** Another ramp under this one. */
export interface Ghost {
  line: "trapezoid" | "earlier";
  text: string;
  timeS: readonly number[];
  /** on these plots [microsteps, pps, pps²] */
  values: Partial<Record<Kind, readonly number[]>>;
}

/** A plot and its height [px]. */
export interface PlotOf {
  kind: Kind;
  height: number;
  onPhone: number;
}

interface Props<P extends string> {
  designer: AnyDesigner;
  /** plots of one group zoom together */
  group: string;
  calculation: Following<Answer>;
  plots: readonly PlotOf[];
  stretches: readonly Stretch[];
  hues: Hues;
  handles: readonly Handle<P>[];
  kinds: Readonly<Record<P, Kind>>;
  onChange: (parameter: P, value: number) => void;
  reach: (parameter: P) => Reach;
  mode: Mode;
  onMode: (mode: Mode) => void;
  peakPps: number;
  /** what there is to say of it besides time and peak */
  noted?: string;
  ghosts: readonly Ghost[];
  held: boolean;
  onHold: (held: boolean) => void;
}

const VALUES: Record<Kind, (answer: Answer) => readonly number[]> = {
  position: (answer) => answer.position,
  velocity: (answer) => answer.velocity_pps,
  acceleration: (answer) => answer.acceleration_pps2,
  jerk: (answer) => answer.jerk_pps3,
};
const LABELS: Record<Kind, string> = {
  position: "Position",
  velocity: "Velocity",
  acceleration: "Acceleration",
  jerk: "Jerk",
};
const INK: Record<Ghost["line"], { light: string; dark: string; dash?: number[] }> = {
  trapezoid: { light: "#8a8f98", dark: "#7b828c", dash: [4, 4] },
  earlier: { light: "#b5a5e3", dark: "#6f62a8" },
};
/** A rival that takes much longer would leave no room for the ramp. */
const MOST_LONGER = 1.6;
/** With names of three lines above it, and of the torque. */
const TORQUE_ON_PHONE_PX = 200;

/** The plots of a ramp with its handles and its torque, its rivals under it. */
export function DesignPlots<P extends string>(props: Props<P>) {
  const { designer, calculation, plots, ghosts } = props;
  const { scale, units, live } = designer;
  const { result } = calculation;
  const scheme = useScheme();
  const phone = usePhone();

  const torque = useMemo(() => (result?.torque ? torqueLines(result.torque, scheme) : null), [result, scheme]);
  const tracks = useMemo(() => {
    if (!result) return [];
    return plots.map(({ kind, height, onPhone }): TrackOf => {
      const per = factor(kind, units, scale);
      const by = (values: readonly number[]) => values.map((value) => value / per);
      const accelerates = kind === "acceleration";
      return {
        kind,
        label: LABELS[kind],
        height: phone ? (accelerates && torque ? TORQUE_ON_PHONE_PX : onPhone) : height,
        data: [result.time_s, by(VALUES[kind](result)), ...(accelerates && torque ? torque.columns : [])],
        color: colorOf(kind, scheme),
        stepped: kind === "jerk",
        symmetric: accelerates || kind === "jerk",
        ghosts: ghosts.flatMap(({ line, timeS, values: { [kind]: values } }): Overlay[] => {
          const { dash, ...ink } = INK[line];
          const look = { color: ink[scheme], ...(dash ? { dash } : {}), width: 1.5, aside: true };
          return values ? [{ x: timeS, y: by(values), ...look }] : [];
        }),
        ...(accelerates ? { more: torque?.series ?? [], marks: marginMark(result) } : {}),
        ...(torque ? { right: phone ? UNSEEN_SCALE : accelerates ? TORQUE_SCALE : NO_SCALE } : {}),
      };
    });
  }, [plots, result, units, scale, scheme, phone, torque, ghosts]);
  const longestS = Math.max(0, ...ghosts.map(({ timeS }) => timeS.at(-1) ?? 0));

  return (
    <RampView
      group={props.group}
      calculation={calculation}
      tracks={tracks}
      stretches={props.stretches}
      hues={props.hues}
      handles={props.handles}
      kindOf={(parameter) => props.kinds[parameter]}
      onChange={props.onChange}
      reach={props.reach}
      distance={designer.sketch.distance}
      onDistance={designer.onDistance}
      scale={scale}
      units={units}
      onUnits={designer.setUnits}
      live={live.live}
      plots={live.plots}
      held={props.held}
      onHold={props.onHold}
      seen={live.seen}
      until={Math.min(longestS, (result?.duration_s ?? 0) * MOST_LONGER)}
      note={
        result && (
          <>
            {time(result.duration_s)} · peak{" "}
            {withUnit(props.peakPps / factor("velocity", units, scale), units.velocity)}
            {props.noted}
          </>
        )
      }
      choice={
        <SegmentedControl
          aria-label="Ramp mode"
          value={props.mode}
          onChange={(mode) => props.onMode(mode === "velocity" ? "velocity" : "position")}
          data={optionsOf({ position: "positioning", velocity: "velocity" })}
        />
      }
      keys={ghosts.map(({ line, text }) => ({ line, text }))}
    />
  );
}
