import { Text } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { useEffect, useId, useRef } from "react";
import type { Schemas } from "../../api/client";
import type { Device } from "../../api/queries";
import { coordinate, fixed } from "../../lib/format";
import { later } from "../../lib/later";
import { scaleOf, toSteps } from "../../lib/units";
import { everyTick } from "../../live/LiveText";
import classes from "./bench.module.css";
import type { LiveAxis } from "./live";
import type { EmulatorState } from "./useEmulator";
import { useSearchEdges } from "./useSearchEdges";
import { useStage } from "./useStage";

const SearchOverlay = later(() => import("./SearchOverlay").then((part) => part.SearchOverlay));

/** how low the spindle lies; with a search, whose zero is named above the lamps */
const RAIL_Y = 49;
const SEARCHED_RAIL_Y = 62;
const START_X = 92;
const PITCH = 9;
const SEARCH_PX = 32;

type SwitchName = "left" | "right" | "home";

/** A lamp's place [px] next to the two others, at least its own width away from both. */
function clearOf(x: number, left: number, right: number): number {
  const apart = 17;
  if (Math.abs(x - left) < apart) return left + (x < left ? -apart : apart);
  return Math.abs(x - right) < apart ? right + (x > right ? apart : -apart) : x;
}

interface Props {
  device: Device;
  axis: Device["axes"][number];
  live: LiveAxis;
  /** undefined for a real device: the drawing then shows what was seen of its switches */
  emulator: EmulatorState | undefined;
  /** the reference search that runs, or the last one */
  search?: Schemas["ReferenceSearchState"] | undefined;
}

function ticksOf(from: number, to: number, most: number): number[] {
  const step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((size) => (to - from) / size <= most) ?? 2000;
  const first = Math.ceil(from / step);
  return Array.from({ length: Math.max(0, Math.floor(to / step) - first + 1) }, (_, index) => (first + index) * step);
}

/** The stage: motor, spindle, carriage, switches and a ruler. It moves as the samples say. */
export function StageDrawing({ device, axis, live, emulator, search }: Props) {
  const thread = useId();
  const searching = search !== undefined && search.state !== "idle";
  const rail = searching ? SEARCHED_RAIL_Y : RAIL_Y;
  // drawn in pixels of its own box, so that nothing is squeezed on a phone
  const { ref: box, width: boxWidth } = useElementSize();
  const width = Math.max(280, Math.floor(boxWidth));
  const travel = width - START_X - 30;
  const carriage = useRef<SVGGElement>(null);
  const spindle = useRef<SVGPatternElement>(null);
  const shaft = useRef<SVGGElement>(null);
  const counted = useRef<SVGGElement>(null);
  const lamps = useRef<Record<string, SVGGElement | null>>({});
  const scale = scaleOf(axis, device.clock_hz);
  const span = useRef(0);

  const stage = useStage(device, axis, live, emulator, (share, offset) => {
    const x = START_X + Math.max(-0.01, Math.min(1.01, share)) * travel;
    carriage.current?.setAttribute("transform", `translate(${coordinate(x)} 0)`);
    // What is known in counts of the motor lies where the counter's zero is now.
    if (!Number.isNaN(offset) && span.current > 0)
      counted.current?.setAttribute("transform", `translate(${coordinate((offset / span.current) * travel)} 0)`);
    // The spindle turns: its thread runs along by one pitch a turn, exaggerated so that slow motion is seen too.
    const turns = (share * span.current) / axis.full_steps_per_rev;
    spindle.current?.setAttribute("patternTransform", `translate(${coordinate((turns * 40) % PITCH)} 0) skewX(-24)`);
    shaft.current?.setAttribute("transform", `rotate(${coordinate((turns * 360) % 360, 1)} 34 ${rail})`);
  });
  const seen = useSearchEdges(live, scale.microstepsPerFullStep ?? 256, search);
  span.current = stage ? stage.to - stage.from : 0;

  useEffect(
    () =>
      everyTick(() => {
        for (const name of ["left", "right", "home"] as const) {
          const lamp = lamps.current[name];
          const value = live.read(`switch_${name}`);
          if (lamp) lamp.dataset.on = String(value > 0.5);
        }
      }),
    [live],
  );

  const height = rail + 38 + (searching ? SEARCH_PX : 0);
  const kind = device.emulated ? "Emulated stage" : "Stage, as far as it was seen,";
  const figure = {
    ref: box,
    className: `${classes.stage} grow shrink m-0 relative`,
    style: { height },
    "aria-label": `${kind} of ${device.name} ${axis.name}`,
    "data-testid": "stage",
  };
  if (!stage && emulator) {
    return (
      <Text size="sm" className="dim grow" p="xs">
        Its shaft turns freely: no stage is emulated.
      </Text>
    );
  }
  if (!stage) return <figure {...figure} aria-busy />; // its place is kept until the emulator has answered
  const at = (fullsteps: number) => START_X + ((fullsteps - stage.from) / (stage.to - stage.from)) * travel;
  const microsteps = scale.microstepsPerFullStep ?? 64;
  const perMm = scale.travelMmPerRev === null ? null : toSteps(1, "mm", scale, "position") / microsteps;
  const perTick = perMm ?? axis.full_steps_per_rev;
  const ticks = ticksOf((stage.from - stage.zero) / perTick, (stage.to - stage.zero) / perTick, travel / 60);
  const tickX = (value: number) => at(value * perTick + stage.zero);
  // Of a real stage a switch that was never met stands, hollow, where it is expected: beyond what was travelled.
  const leftX = stage.left === null ? START_X + 4 : at(stage.left);
  const rightX = stage.right === null ? START_X + travel - 4 : at(stage.right);
  const homeEdges = [stage.homeFrom, stage.homeTo].filter((edge): edge is number => edge !== null);
  const homeX = homeEdges.length === 0 ? null : homeEdges.reduce((sum, edge) => sum + at(edge), 0) / homeEdges.length;
  // The lamp of a switch is over it, unless another one's is there.
  const switchMark = (name: SwitchName, x: number, label: string, known: boolean, lampX = x) => (
    <g
      ref={(node) => {
        lamps.current[name] = node;
      }}
      className={classes.switchMark}
      data-forced={stage.forced[name]}
      data-known={known}
    >
      <path d={`M${lampX} ${rail - 34} v6 L${x} ${rail - 20} v8`} />
      <circle cx={lampX} cy={rail - 40} r={7} />
      <text x={lampX} y={rail - 36.4} textAnchor="middle">
        {label}
      </text>
    </g>
  );
  return (
    <figure {...figure}>
      <svg width={width} height={height} role="img" aria-label={`Carriage of ${axis.name} between its switches`}>
        <defs>
          <pattern ref={spindle} id={thread} width={PITCH} height="12" patternUnits="userSpaceOnUse">
            <rect width={PITCH} height="12" fill="var(--steel-4)" />
            <rect width={PITCH / 2.6} height="12" fill="var(--steel-2)" />
          </pattern>
        </defs>
        <rect x={START_X - 8} y={rail + 13} width={travel + 22} height={5} rx={1} fill="var(--steel-3)" />
        <rect x={66} y={rail - 5} width={width - 66 - 12} height={10} fill={`url(#${thread})`} />
        <rect x={6} y={rail - 26} width={56} height={52} rx={4} fill="var(--steel-0)" />
        <rect x={62} y={rail - 12} width={8} height={24} rx={1} fill="var(--steel-3)" />
        <circle cx={34} cy={rail} r={17} fill="var(--steel-1)" />
        <g ref={shaft}>
          <circle cx={34} cy={rail} r={8} fill="var(--shaft)" />
          <path d={`M34 ${rail - 8} v9`} stroke="var(--steel-0)" strokeWidth={3} />
        </g>
        <rect x={width - 14} y={rail - 14} width={10} height={32} rx={2} fill="var(--steel-3)" />
        {ticks.map((value) => (
          <g key={value}>
            <path className="stroke-dim" d={`M${tickX(value)} ${rail + 18} v5`} />
            <text x={tickX(value)} y={rail + 34} textAnchor="middle" className="text-12 fill-dim">
              {fixed(value)}
            </text>
          </g>
        ))}
        {stage.homeFrom !== null && stage.homeTo !== null && (
          <rect
            x={at(stage.homeFrom)}
            y={rail + 9}
            width={Math.max(3, at(stage.homeTo) - at(stage.homeFrom))}
            height={4}
            fill="var(--lamp)"
          />
        )}
        {switchMark("left", leftX, "L", stage.left !== null)}
        {switchMark("right", rightX, "R", stage.right !== null)}
        {homeX !== null && switchMark("home", homeX, "H", true, clearOf(homeX, leftX, rightX))}
        <g ref={carriage}>
          <rect x={-22} y={rail - 14} width={44} height={28} rx={3} className="fill-accent" />
          <path d={`M-22 ${rail + 14} h44`} stroke="var(--accent-text)" strokeWidth={3} />
          <path d={`M0 ${rail - 14} v28`} stroke="color-mix(in srgb, white 55%, transparent)" strokeWidth={1.5} />
          <path d={`M-4 ${rail - 20} h8 l-4 6 z`} className="fill-accent" />
        </g>
        {searching && (
          <SearchOverlay
            search={search}
            microsteps={scale.microstepsPerFullStep ?? 256}
            counted={counted}
            seen={seen}
            place={at}
            left={START_X}
            width={travel}
            rail={rail}
          />
        )}
      </svg>
      <Text size="xs" c="dimmed" pos="absolute" right={2} top={rail + 20} aria-hidden>
        {perMm === null ? "turns" : "mm"}
      </Text>
    </figure>
  );
}
