import { Center, Select } from "@mantine/core";
import { type ReactNode, type RefObject, useMemo, useRef } from "react";
import type { PlotData } from "../../plots/series";
import type { Mark, Overlay, PlotHandle, PlotScale, PlotSeries } from "../../plots/types";
import { Card } from "../Card";
import { withUnit } from "../format";
import { NumberField } from "../NumberField";
import { ProblemAlert } from "../ProblemAlert";
import type { AxisScale } from "../units";
import type { Following } from "../useFollow";
import { useScheme } from "../useScheme";
import type { Answer, Kind } from "./answer";
import type { Reach } from "./HandleLayer";
import type { Handle } from "./handles";
import { type Hues, hueOf, phaseBands, type Stretch } from "./phases";
import { factor, time, type Units, unitChoices } from "./scales";
import { Track } from "./Track";

export type PlotHandles = Partial<Record<Kind, RefObject<PlotHandle | null>>>;
/** What is drawn over the ramp from outside: the motion of the chip, by plot. */
export type LiveOverlays = (kind: Kind) => readonly Overlay[];

/** One plot of a ramp, in the units of the page. */
export interface TrackOf {
  kind: Kind;
  label: string;
  height: number;
  /** time, the quantity itself, and whatever `more` names */
  data: PlotData;
  color: string;
  stepped?: boolean;
  /** braking is as large as accelerating: 0 stays in the middle */
  symmetric?: boolean;
  more?: readonly PlotSeries[];
  right?: PlotScale;
  /** lines under what is live; drawn as they are when a plot draws */
  ghosts?: readonly Overlay[];
  marks?: readonly Mark[];
}

interface Props<P extends string> {
  /** plots of one group zoom together */
  group: string;
  calculation: Following<Answer>;
  tracks: readonly TrackOf[];
  stretches: readonly Stretch[];
  hues: Hues;
  handles: readonly Handle<P>[];
  kindOf: (parameter: P) => Kind;
  onChange: (parameter: P, value: number) => void;
  reach: (parameter: P) => Reach;
  distance: number;
  onDistance: (steps: number) => void;
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
  /** how long it is to be seen at least [s]: rivals may take longer */
  until?: number;
  note: ReactNode;
  /** before the distance: the choice of a mode */
  choice?: ReactNode;
  /** what the ghosts are: their line's name in the stylesheet, and words */
  keys: readonly { line: string; text: string }[];
}

const POSITION_MAX = 2 ** 31 - 1;

/** A ramp over time with its handles: a plot for each quantity, phases as bands, the chip's own motion over it. */
export function RampView<P extends string>(props: Props<P>) {
  const { calculation, tracks, stretches, hues, distance, scale, units, held, live } = props;
  const { result, stale, error, retry } = calculation;
  const scheme = useScheme();
  const end = useWindow(Math.max(result?.time_s.at(-1) ?? 1, props.until ?? 0), held);
  const bands = useMemo(
    () => ({ named: phaseBands(stretches, hues, scheme, true), plain: phaseBands(stretches, hues, scheme, false) }),
    [stretches, hues, scheme],
  );
  const perPosition = factor("position", units, scale);
  const per = (kind: Kind) => factor(kind, units, scale);

  // Functions that stay: a plot draws with what they say then, and is not told of every answer twice.
  const drawn = useRef(tracks);
  drawn.current = tracks;
  const drawers = useRef(new Map<Kind, { overlays: () => Overlay[]; marks: () => readonly Mark[] }>());
  const latestLive = useRef(live);
  latestLive.current = live;
  const drawerOf = (kind: Kind) => {
    const known = drawers.current.get(kind);
    if (known) return known;
    const own = () => drawn.current.find((track) => track.kind === kind);
    const made = {
      overlays: () => [...(own()?.ghosts ?? []), ...latestLive.current(kind)],
      marks: () => own()?.marks ?? [],
    };
    drawers.current.set(kind, made);
    return made;
  };
  const text = (parameter: P, value: number) => {
    const kind = props.kindOf(parameter);
    return withUnit(value / per(kind), units[kind], 5);
  };
  // the names of the phases stand where their heights differ most
  const named = tracks.some((track) => track.kind === "velocity") ? "velocity" : tracks[0]?.kind;

  return (
    <Card
      title="Ramp"
      note={result ? <span className={`num ${error !== null ? "stale" : ""}`}>{props.note}</span> : ""}
      actions={
        <>
          {props.choice}
          <div className="flex gap-6">
            <NumberField
              aria-label={`Distance in ${units.position}`}
              value={distance / perPosition}
              min={-POSITION_MAX / perPosition}
              max={POSITION_MAX / perPosition}
              step={Math.abs(distance / perPosition) / 100 || 1}
              unit={units.position}
              w={150}
              onChange={(value) => props.onDistance(Math.round(value * perPosition))}
            />
            <Select
              aria-label="Units"
              w={96}
              data={unitChoices(scale).map(({ key, label }) => ({ value: key, label }))}
              value={units.key}
              onChange={(key) => key && props.onUnits(key)}
            />
          </div>
        </>
      }
    >
      {error !== null && <ProblemAlert error={error} doing="Calculating the ramp" retry={retry} />}
      {result ? (
        <div className={error !== null ? "stale" : undefined} aria-busy={stale}>
          {tracks.map((track, index) => {
            const most = (track.data[1] as readonly number[]).reduce((so, value) => Math.max(so, Math.abs(value)), 0);
            const drawer = drawerOf(track.kind);
            const handle = props.plots[track.kind];
            if (handle === undefined) return null;
            return (
              <Track
                key={track.kind}
                group={props.group}
                label={track.label}
                summary={`At most ${withUnit(most, units[track.kind])} within ${time(result.duration_s)}`}
                handle={handle}
                series={[
                  {
                    label: track.label.toLowerCase(),
                    color: track.color,
                    unit: units[track.kind],
                    width: 2,
                    stepped: track.stepped ?? false,
                  },
                  ...(track.more ?? []),
                ]}
                data={track.data}
                window={[0, end]}
                bands={track.kind === named ? bands.named : bands.plain}
                height={track.height}
                symmetric={track.symmetric ?? false}
                overlays={drawer.overlays}
                {...(track.marks ? { marks: drawer.marks } : {})}
                {...(track.right ? { right: track.right } : {})}
                last={index === tracks.length - 1}
                handles={props.handles.filter((each) => each.track === track.kind)}
                factor={per(track.kind)}
                reach={props.reach}
                text={text}
                onChange={props.onChange}
                held={held}
                onHold={props.onHold}
              />
            );
          })}
          <PhaseList phases={stretches} hues={hues} />
          <Key keys={props.keys} seen={props.seen} />
          {result.findings
            .filter((finding) => finding.parameter === null)
            .map((finding) => (
              <p key={finding.code} className="m-0 caution text-12">
                {finding.text}
              </p>
            ))}
        </div>
      ) : (
        error === null && (
          <Center mih={560} className="dim text-13">
            calculating the ramp
          </Center>
        )
      )}
    </Card>
  );
}

/** How far time goes: a little more than the ramp needs, without jumping at every change. */
function useWindow(ends: number, held: boolean): number {
  const last = useRef(0);
  const wanted = ends > 0 ? ends * 1.02 : 1;
  const keep = held ? wanted <= last.current : wanted <= last.current && wanted > last.current * 0.9;
  if (!keep) last.current = held ? wanted * 1.15 : wanted;
  return last.current;
}

/** Every phase with its time; those that take none are there as well, and look so. */
function PhaseList({ phases, hues }: { phases: readonly Stretch[]; hues: Hues }) {
  const scheme = useScheme();
  return (
    <ol className="list under-plot lines-12 hint mt-4" aria-label="Phases">
      {phases.map((phase, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: phases may come twice on the way through a reversal
        <li key={`${phase.name} ${index}`} className="inline gap-4">
          <span
            className={`swatch swatch-square ${phase.empty ? "faint" : ""}`}
            style={{ background: hueOf(phase.name, hues, scheme) }}
            aria-hidden
          />
          {phase.name}{" "}
          <span className={`num ${phase.empty ? "" : "ink"}`}>
            {phase.empty ? "0" : time(phase.endS - phase.startS)}
          </span>
        </li>
      ))}
    </ol>
  );
}

const LINE_LOOKS: Record<string, string> = {
  earlier: "hue-violet faint",
  measured: "key-dotted hue-text",
  predicted: "key-dashed hue-orange",
};

/** What the lines besides the ramp are. */
function Key({ keys, seen }: { keys: Props<string>["keys"]; seen: boolean }) {
  const live = seen
    ? [
        { line: "measured", text: "measured" },
        { line: "predicted", text: "predicted" },
      ]
    : [];
  return (
    <p className="under-plot lines-12 hint m-0 mt-4">
      {[...keys, ...live].map(({ line, text }) => (
        <span key={line}>
          <i className={`key-line ${LINE_LOOKS[line] ?? "key-dashed hue-grey"}`} aria-hidden /> {text}
        </span>
      ))}
      <span>drag the handles, or focus one and use the arrow keys</span>
    </p>
  );
}
