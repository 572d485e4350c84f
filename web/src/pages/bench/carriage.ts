import { useRef } from "react";
import { TURNS } from "../../live/turns";
import { useFrame } from "../../live/useFrame";
import { emulatedAxis, type StagePlaces } from "./emulation";
import type { LiveAxis } from "./live";
import type { EmulatorState } from "./useEmulator";

/** Where things stand on a stage, as shares 0..1 of what is drawn. */
export interface StageGeometry {
  from: number;
  to: number;
  left: number;
  right: number;
  homeFrom: number | null;
  homeTo: number | null;
}

/** The stage with a margin beyond its end switches, in full steps; switches as shares of it. */
export function geometryOf(places: StagePlaces, margin = 0.06): StageGeometry {
  const span = places.right - places.left;
  const from = places.left - margin * span;
  const to = places.right + margin * span;
  const share = (at: number) => (at - from) / (to - from);
  const home = (at: number | null) => (at === null ? null : share(at));
  return {
    from,
    to,
    left: share(places.left),
    right: share(places.right),
    homeFrom: home(places.homeFrom),
    homeTo: home(places.homeTo),
  };
}

/**
 * Mechanical position [full steps] minus the chip's count in full steps: it changes when the counter is set,
 * not when the motor moves. The emulator's answer bears its chip time, so that it is compared with the sample of then.
 */
export function countOffset(
  mechanicalFullsteps: number,
  chipTimeS: number,
  live: Pick<LiveAxis, "source">,
  axis: number,
  microsteps: number,
): number {
  const then = live.source?.buffer.at(`position.${axis}`, chipTimeS) ?? Number.NaN;
  return mechanicalFullsteps - then / microsteps;
}

/** Calls `place` in every frame with the carriage's place, 0..1 of the drawn stage, from live samples. */
export function useCarriage(
  live: LiveAxis,
  axis: number,
  emulator: EmulatorState | undefined,
  microsteps: number | null,
  place: (share: number, offsetFullsteps: number) => void,
): void {
  const offset = useRef({ state: emulator, fullsteps: Number.NaN });
  useFrame((nowMs) => {
    const stage = emulatedAxis(emulator, axis);
    if (!stage || !TURNS.take("stage", nowMs)) return;
    const geometry = geometryOf(stage.places);
    const share = (fullsteps: number) => (fullsteps - geometry.from) / (geometry.to - geometry.from);
    if (microsteps === null) {
      place(share(stage.positionFullsteps), Number.NaN);
      return;
    }
    if (offset.current.state !== emulator || Number.isNaN(offset.current.fullsteps)) {
      const next = countOffset(stage.positionFullsteps, stage.chipTimeS, live, axis, microsteps);
      // Samples are 33 ms apart: what looks like a small change while it moves is only that. At rest it is lost steps.
      if (!(live.moving() && Math.abs(next - offset.current.fullsteps) < 40) && !Number.isNaN(next))
        offset.current.fullsteps = next;
      offset.current.state = emulator;
    }
    const mechanical = live.read("position") / microsteps + offset.current.fullsteps;
    place(share(Number.isNaN(mechanical) ? stage.positionFullsteps : mechanical), offset.current.fullsteps);
  });
}
