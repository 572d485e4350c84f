import { SegmentedControl, Select } from "@mantine/core";
import { type RefObject, useMemo, useRef } from "react";
import { compact, withUnit } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { colorOf } from "../../lib/palette";
import { Section } from "../../lib/Section";
import type { AxisScale } from "../../lib/units";
import { usePhone } from "../../lib/usePhone";
import { useScheme } from "../../lib/useScheme";
import type { Mark, Overlay, PlotHandle } from "../../plots/types";
import type { Band } from "../../plots/usePlotBands";
import { type Answer, type Design, KIND, type Kind, type Mode, type Options, type Parameter, used } from "./design";
import type { Reach } from "./HandleLayer";
import { handlesOf, shownHandles } from "./handles";
import { marginText } from "./motor";
import { faded, hueOf, type Stretch, stretches } from "./phases";
import { corners } from "./rivals";
import { factor, time, type Units, unitChoices } from "./scales";
import classes from "./sramp.module.css";
import { Track } from "./Track";
import { NO_SCALE, TORQUE_SCALE, torqueLines, UNSEEN_SCALE } from "./torque";
import type { Following } from "./useFollow";

/** What is drawn over the ramp from outside: the motion of the chip, by plot. */
export type LiveOverlays = Record<Kind, () => readonly Overlay[]>;

export interface PlotHandles {
  velocity: RefObject<PlotHandle | null>;
  acceleration: RefObject<PlotHandle | null>;
  jerk: RefObject<PlotHandle | null>;
}

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
  /** a handle is held */
  held: boolean;
  onHold: (held: boolean) => void;
  /** a motion of the chip lies over the ramp */
  seen: boolean;
}

const POSITION_MAX = 2 ** 31 - 1;

export function SRampPlots(props: Props) {
  const { calculation, design, options, onOptions, distance, onDistance, reach, scale, units } = props;
  const { held } = props;
  const { result, stale, error, retry } = calculation;
  const scheme = useScheme();
  const phone = usePhone();
  const end = useWindow(result, held);
  const way = distance < 0 ? -1 : 1;

  const factors = useMemo(
    () => ({
      position: factor("position", units, scale),
      velocity: factor("velocity", units, scale),
      acceleration: factor("acceleration", units, scale),
      jerk: factor("jerk", units, scale),
    }),
    [units, scale],
  );
  const torque = useMemo(() => (result?.torque ? torqueLines(result.torque, scheme) : null), [result, scheme]);
  const columns = useMemo(() => {
    if (!result) return null;
    const times = result.time_s;
    const by = (values: readonly number[], divisor: number) => values.map((value) => value / divisor);
    return {
      velocity: [times, by(result.velocity_pps, factors.velocity)] as const,
      acceleration: [
        times,
        by(result.acceleration_pps2, factors.acceleration),
        ...(torque ? torque.columns : []),
      ] as const,
      jerk: [times, by(result.jerk_pps3, factors.jerk)] as const,
    };
  }, [result, factors, torque]);
  const worst = result?.torque ?? null;
  const marks = useMemo<Mark[]>(() => {
    if (worst === null) return [];
    // the knobs of AMAX stand above, those of DMAX below
    const row = result?.time_s.findIndex((at) => at >= worst.margin_at_s) ?? 0;
    const low = (result?.acceleration_pps2[row] ?? 0) >= 0;
    return [
      { id: "margin", x: worst.margin_at_s, color: "#7a5200", label: marginText(worst.margin), fixed: true, low },
    ];
  }, [worst, result]);
  const shown = useMemo(() => (result ? stretches(result.phases, options.shape) : []), [result, options.shape]);
  const bands = useMemo(
    () => ({ named: phaseBands(shown, scheme, true), plain: phaseBands(shown, scheme, false) }),
    [shown, scheme],
  );
  const handles = useMemo(
    () => (result ? handlesOf(design, shownHandles(used(options), options), shown, result.duration_s, way) : []),
    [design, options, shown, result, way],
  );

  // the trapezoid of the same limits lies under the velocity, what the chip does over it
  const trapezoid = result?.rivals.find((rival) => rival.name === "trapezoid");
  const ghost = useMemo<Overlay[]>(() => {
    if (!trapezoid) return [];
    const { x, y } = corners(trapezoid, way);
    const color = scheme === "light" ? "#8a8f98" : "#7b828c";
    return [{ x, y: y.map((value) => value / factors.velocity), color, dash: [4, 4], aside: true }];
  }, [trapezoid, way, factors, scheme]);
  // Functions that stay: a plot draws with what they say then, and is not told of every answer twice.
  const drawn = useRef({ ghost, marks });
  drawn.current = { ghost, marks };
  const { live } = props;
  const overlays = useMemo(
    () => ({
      velocity: () => [...drawn.current.ghost, ...live.velocity()],
      acceleration: live.acceleration,
      jerk: live.jerk,
      marks: () => drawn.current.marks,
    }),
    [live],
  );

  const text = (parameter: Parameter, value: number) =>
    withUnit(value / factors[KIND[parameter]], units[KIND[parameter]], 5);
  const peak = result ? Math.max(...result.limits.filter((limit) => limit.name === "VMAX").map(({ peak }) => peak)) : 0;
  const track = (kind: Kind, label: string, height: number) => {
    if (!columns || !result) return null;
    const most = columns[kind][1].reduce((so, value) => Math.max(so, Math.abs(value)), 0);
    return (
      <Track
        label={label}
        summary={`At most ${withUnit(most, units[kind])} within ${time(result.duration_s)}`}
        handle={props.plots[kind]}
        series={[
          {
            label: label.toLowerCase(),
            color: colorOf(kind === "jerk" ? "residual" : kind, scheme),
            unit: units[kind],
            width: 2,
            stepped: kind === "jerk",
          },
          ...(kind === "acceleration" && torque ? torque.series : []),
        ]}
        data={columns[kind]}
        window={[0, end]}
        bands={kind === "velocity" ? bands.named : bands.plain}
        height={height}
        symmetric={kind !== "velocity"}
        overlays={overlays[kind]}
        {...(kind === "acceleration" ? { marks: overlays.marks } : {})}
        {...(torque ? { right: phone ? UNSEEN_SCALE : kind === "acceleration" ? TORQUE_SCALE : NO_SCALE } : {})}
        last={kind === "jerk"}
        handles={handles.filter((handle) => handle.track === kind)}
        factor={factors[kind]}
        reach={reach}
        text={text}
        onChange={props.onChange}
        held={held}
        onHold={props.onHold}
      />
    );
  };

  return (
    <Section
      title="Ramp"
      note={
        result ? (
          <span className={`num ${error !== null ? "stale" : ""}`}>
            {time(result.duration_s)} · peak {withUnit(peak / factors.velocity, units.velocity)}
            {options.mode === "position" && ` · overshoot ${compact(result.overshoot_steps)} µsteps`}
          </span>
        ) : (
          ""
        )
      }
      actions={
        <>
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
          <div className={classes.distance}>
            <NumberField
              aria-label={`Distance in ${units.position}`}
              value={distance / factors.position}
              min={-POSITION_MAX / factors.position}
              max={POSITION_MAX / factors.position}
              step={Math.abs(distance / factors.position) / 100 || 1}
              unit={units.position}
              w={150}
              onChange={(value) => onDistance(Math.round(value * factors.position))}
            />
            <Select
              aria-label="Units"
              size="xs"
              w={96}
              data={unitChoices(scale).map(({ key, label }) => ({ value: key, label }))}
              value={units.key}
              allowDeselect={false}
              onChange={(key) => key && props.onUnits(key)}
            />
          </div>
        </>
      }
    >
      {error !== null && <ProblemAlert error={error} doing="Calculating the ramp" retry={retry} />}
      {columns && result ? (
        <div className={error !== null ? "stale" : undefined} aria-busy={stale}>
          {track("velocity", "Velocity", phone ? 170 : 190)}
          {options.shape !== "hold" && track("acceleration", "Acceleration", phone ? (torque ? 200 : 160) : 172)}
          {options.shape === "s" && track("jerk", "Jerk", phone ? 170 : 188)}
          <PhaseList phases={shown} />
          <Key trapezoid={trapezoid !== undefined} seen={props.seen} />
          {result.findings
            .filter((finding) => finding.parameter === null)
            .map((finding) => (
              <p key={finding.code} className={classes.caution}>
                {finding.text}
              </p>
            ))}
        </div>
      ) : (
        error === null && <div className={classes.plotNote}>calculating the ramp</div>
      )}
    </Section>
  );
}

/** How far time goes: a little more than the ramp needs, without jumping at every change. */
function useWindow(result: Answer | undefined, held: boolean): number {
  const last = useRef(0);
  const ends = result?.time_s.at(-1) ?? 1;
  const wanted = ends > 0 ? ends * 1.02 : 1;
  const keep = held ? wanted <= last.current : wanted <= last.current && wanted > last.current * 0.9;
  if (!keep) last.current = held ? wanted * 1.15 : wanted;
  return last.current;
}

function phaseBands(phases: readonly Stretch[], scheme: "light" | "dark", named: boolean): Band[] {
  return phases
    .filter((phase) => !phase.empty)
    .map((phase) => ({
      from: phase.startS,
      to: phase.endS,
      color: faded(hueOf(phase.name, scheme), scheme === "light" ? 0.17 : 0.2),
      ...(named ? { label: phase.name, labelColor: scheme === "light" ? "#374151" : "#d3d8de" } : {}),
    }));
}

/** Every phase with its time; those that take none are there as well, and look so. */
function PhaseList({ phases }: { phases: readonly Stretch[] }) {
  const scheme = useScheme();
  return (
    <ol className={classes.phases} aria-label="Phases">
      {phases.map((phase, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: phases may come twice on the way through a reversal
        <li key={`${phase.name} ${index}`} data-empty={phase.empty || undefined}>
          <span className={classes.swatch} style={{ background: hueOf(phase.name, scheme) }} aria-hidden />
          {phase.name} <span className="num">{phase.empty ? "0" : time(phase.endS - phase.startS)}</span>
        </li>
      ))}
    </ol>
  );
}

/** What the lines besides the ramp are. */
function Key({ trapezoid, seen }: { trapezoid: boolean; seen: boolean }) {
  return (
    <p className={classes.key}>
      {trapezoid && (
        <span>
          <i data-line="trapezoid" aria-hidden /> trapezoid of the same limits
        </span>
      )}
      {seen && (
        <>
          <span>
            <i data-line="measured" aria-hidden /> measured
          </span>
          <span>
            <i data-line="predicted" aria-hidden /> predicted
          </span>
        </>
      )}
      <span>drag the handles, or focus one and use the arrow keys</span>
    </p>
  );
}
