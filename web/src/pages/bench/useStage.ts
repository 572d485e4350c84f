import { useRef, useState } from "react";
import type { Device } from "../../api/queries";
import { useFrame } from "../../live/useFrame";
import { lowerBound } from "../../plots/series";
import { geometryOf, useCarriage } from "./carriage";
import { emulatedAxis } from "./emulation";
import type { LiveAxis } from "./live";
import { type Look, ObservedStage } from "./observed";
import type { EmulatorState } from "./useEmulator";

type SwitchName = "left" | "right" | "home";

/** A stage to draw, in full steps: of the emulated plant, or as it was seen from outside. */
export interface Stage {
  from: number;
  to: number;
  left: number | null;
  right: number | null;
  homeFrom: number | null;
  homeTo: number | null;
  forced: Record<SwitchName, boolean>;
  /** the places are only what was seen of them */
  inferred: boolean;
  /** where the ruler's zero is */
  zero: number;
}

const NOT_FORCED = { left: false, right: false, home: false };

/** The stage of an emulated axis; undefined while its emulator has not answered. */
export function emulatedStage(emulator: EmulatorState | undefined, axis: number): Stage | undefined {
  const found = emulatedAxis(emulator, axis);
  if (!found) return undefined;
  const { places, switches } = found;
  const { from, to } = geometryOf(places);
  return {
    ...places,
    from,
    to,
    zero: places.left,
    inferred: false,
    forced: {
      left: switches.left.forced !== null,
      right: switches.right.forced !== null,
      home: switches.home !== null && switches.home.forced !== null,
    },
  };
}

function observedStage(seen: ObservedStage, fullStepsPerTurn: number): Stage {
  const [from, to] = seen.range(fullStepsPerTurn);
  const { left, right, homeFrom, homeTo } = seen;
  return { from, to, left, right, homeFrom, homeTo, forced: NOT_FORCED, inferred: true, zero: 0 };
}

/** Every look at the axis since `afterS`, from its samples: a frame may bring several, and an edge may be between. */
export function looksSince(live: LiveAxis, microsteps: number, afterS: number): Look[] {
  const times = live.source?.buffer.times();
  if (!times) return [];
  const looks: Look[] = [];
  for (let row = lowerBound(times, afterS); row < times.length; row++) {
    const timeS = times[row] as number;
    if (timeS <= afterS) continue;
    looks.push({
      timeS,
      position: live.at("position", row) / microsteps,
      speed: live.at("velocity", row) / microsteps,
      left: live.at("switch_left", row),
      right: live.at("switch_right", row),
      home: live.at("switch_home", row),
    });
  }
  return looks;
}

/**
 * The stage of an axis, and in every frame its carriage: `place` gets the carriage's share 0..1 of what is drawn, and
 * what has to be added to the counter to get a place of the stage [full steps].
 */
export function useStage(
  device: Device,
  axis: Device["axes"][number],
  live: LiveAxis,
  emulator: EmulatorState | undefined,
  place: (share: number, offsetFullsteps: number) => void,
): Stage | undefined {
  const microsteps = axis.microsteps_per_full_step ?? 256;
  const [seen] = useState(() => new ObservedStage());
  const [observed, setObserved] = useState(() => observedStage(seen, axis.full_steps_per_rev));
  const revision = useRef(0);
  useCarriage(live, axis.index, emulator, axis.microsteps_per_full_step, place);
  useFrame(() => {
    if (device.emulated) return;
    for (const look of looksSince(live, microsteps, seen.lookedAtS)) seen.look(look);
    if (revision.current !== seen.revision) {
      revision.current = seen.revision;
      const next = observedStage(seen, axis.full_steps_per_rev);
      if (JSON.stringify(next) !== JSON.stringify(observed)) setObserved(next);
    }
    const position = live.read("position") / microsteps;
    if (!Number.isNaN(position)) place((position - observed.from) / (observed.to - observed.from), 0);
  });
  return device.emulated ? emulatedStage(emulator, axis.index) : observed;
}
