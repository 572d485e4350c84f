import { Text } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { useEffect, useId, useRef } from "react";
import type { Device } from "../../api/queries";
import { fixed } from "../../lib/format";
import { scaleOf, toSteps } from "../../lib/units";
import { everyTick } from "../../live/LiveText";
import classes from "./bench.module.css";
import { geometryOf, useCarriage } from "./carriage";
import type { LiveAxis } from "./live";
import type { EmulatorState } from "./useEmulator";

const RAIL_Y = 62;
const START_X = 92;
const PITCH = 9;

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
  emulator: EmulatorState;
}

function ticksOf(from: number, to: number, most: number): number[] {
  const step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((size) => (to - from) / size <= most) ?? 2000;
  const first = Math.ceil(from / step);
  return Array.from({ length: Math.max(0, Math.floor(to / step) - first + 1) }, (_, index) => (first + index) * step);
}

/** The emulated stage: motor, spindle, carriage, switches and a ruler. It moves as the samples say. */
export function StageDrawing({ device, axis, live, emulator }: Props) {
  const thread = useId();
  // drawn in pixels of its own box, so that nothing is squeezed on a phone
  const { ref: box, width: boxWidth } = useElementSize();
  const width = Math.max(280, Math.floor(boxWidth));
  const travel = width - START_X - 30;
  const carriage = useRef<SVGGElement>(null);
  const spindle = useRef<SVGPatternElement>(null);
  const shaft = useRef<SVGGElement>(null);
  const lamps = useRef<Record<string, SVGGElement | null>>({});
  const state = emulator.axes.find((candidate) => candidate.axis === axis.index);
  const scale = scaleOf(axis, device.clock_hz);
  const geometry = state && geometryOf(state.stage);
  const span = geometry ? geometry.to - geometry.from : 0;

  useCarriage(live, axis.index, emulator, axis.microsteps_per_full_step, (share) => {
    const x = START_X + Math.max(-0.01, Math.min(1.01, share)) * travel;
    carriage.current?.setAttribute("transform", `translate(${x.toFixed(2)} 0)`);
    // The spindle turns: its thread runs along by one pitch a turn, exaggerated so that slow motion is seen too.
    const turns = (share * span) / axis.full_steps_per_rev;
    spindle.current?.setAttribute("patternTransform", `translate(${((turns * 40) % PITCH).toFixed(2)} 0) skewX(-24)`);
    shaft.current?.setAttribute("transform", `rotate(${((turns * 360) % 360).toFixed(1)} 34 ${RAIL_Y})`);
  });

  useEffect(
    () =>
      everyTick(() => {
        for (const name of ["left", "right", "reference"] as const) {
          const lamp = lamps.current[name];
          const value = live.read(`switch_${name}`);
          if (lamp) lamp.dataset.on = String(value > 0.5);
        }
      }),
    [live],
  );

  if (!state || !geometry) return null;
  const at = (share: number) => START_X + share * travel;
  const microsteps = scale.microstepsPerFullStep ?? 64;
  const perMm = scale.travelMmPerRev === null ? null : toSteps(1, "mm", scale, "position") / microsteps;
  const perTick = perMm ?? axis.full_steps_per_rev;
  const { left_at_fullsteps: zero } = state.stage;
  const ticks = ticksOf((geometry.from - zero) / perTick, (geometry.to - zero) / perTick, travel / 60);
  const reference = (at(geometry.refFrom) + at(geometry.refTo)) / 2;
  const tickX = (value: number) => at((value * perTick + zero - geometry.from) / (geometry.to - geometry.from));
  const forced = (name: "left" | "right" | "reference") => state.switches[name].forced !== null;
  // The lamp of a switch is over it, unless another one's is there.
  const switchMark = (name: "left" | "right" | "reference", x: number, label: string, lampX = x) => (
    <g
      ref={(node) => {
        lamps.current[name] = node;
      }}
      className={classes.switchMark}
      data-forced={forced(name)}
    >
      <path d={`M${lampX} ${RAIL_Y - 34} v6 L${x} ${RAIL_Y - 20} v8`} />
      <circle cx={lampX} cy={RAIL_Y - 40} r={7} />
      <text x={lampX} y={RAIL_Y - 36.4} textAnchor="middle">
        {label}
      </text>
    </g>
  );

  return (
    <figure ref={box} className={classes.stage} aria-label={`Emulated stage of ${device.name} ${axis.name}`}>
      <svg width={width} height={100} role="img" aria-label={`Carriage of ${axis.name} between its switches`}>
        <defs>
          <pattern ref={spindle} id={thread} width={PITCH} height="12" patternUnits="userSpaceOnUse">
            <rect width={PITCH} height="12" className={classes.spindleGround} />
            <rect width={PITCH / 2.6} height="12" className={classes.spindleThread} />
          </pattern>
        </defs>
        <rect x={START_X - 8} y={RAIL_Y + 13} width={travel + 22} height={5} rx={1} className={classes.bed} />
        <rect x={66} y={RAIL_Y - 5} width={width - 66 - 12} height={10} fill={`url(#${thread})`} />
        <rect x={6} y={RAIL_Y - 26} width={56} height={52} rx={4} className={classes.motor} />
        <rect x={62} y={RAIL_Y - 12} width={8} height={24} rx={1} className={classes.bed} />
        <circle cx={34} cy={RAIL_Y} r={17} className={classes.motorFace} />
        <g ref={shaft}>
          <circle cx={34} cy={RAIL_Y} r={8} className={classes.shaft} />
          <path d={`M34 ${RAIL_Y - 8} v9`} className={classes.shaftKey} />
        </g>
        <rect x={width - 14} y={RAIL_Y - 14} width={10} height={32} rx={2} className={classes.bed} />
        {ticks.map((value) => (
          <g key={value} className={classes.tick}>
            <path d={`M${tickX(value)} ${RAIL_Y + 18} v5`} />
            <text x={tickX(value)} y={RAIL_Y + 34} textAnchor="middle" className={classes.tickText}>
              {fixed(value)}
            </text>
          </g>
        ))}
        <rect
          x={at(geometry.refFrom)}
          y={RAIL_Y + 9}
          width={Math.max(3, at(geometry.refTo) - at(geometry.refFrom))}
          height={4}
          className={classes.flag}
        />
        {switchMark("left", at(geometry.left), "L")}
        {switchMark("right", at(geometry.right), "R")}
        {switchMark("reference", reference, "H", clearOf(reference, at(geometry.left), at(geometry.right)))}
        <g ref={carriage}>
          <rect x={-22} y={RAIL_Y - 14} width={44} height={28} rx={3} className={classes.carriage} />
          <path d={`M-22 ${RAIL_Y + 14} h44`} className={classes.carriageFoot} />
          <path d={`M0 ${RAIL_Y - 14} v28`} className={classes.carriageLine} />
          <path d={`M-4 ${RAIL_Y - 20} h8 l-4 6 z`} className={classes.carriagePointer} />
        </g>
      </svg>
      <Text size="xs" c="dimmed" className={classes.stageUnit} aria-hidden>
        {perMm === null ? "turns" : "mm"}
      </Text>
    </figure>
  );
}
