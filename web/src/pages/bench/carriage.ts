import { useRef } from "react";
import { useFrame } from "../../live/useFrame";
import type { LiveAxis } from "./live";
import type { EmulatorAxis, EmulatorState } from "./useEmulator";

/** Where things stand on a stage, as shares 0..1 of what is drawn. */
export interface StageGeometry {
  from: number;
  to: number;
  left: number;
  right: number;
  refFrom: number;
  refTo: number;
}

/** The stage with a margin beyond its end switches, in full steps; switches as shares of it. */
export function geometryOf(stage: EmulatorAxis["stage"], margin = 0.06): StageGeometry {
  const span = stage.right_at_fullsteps - stage.left_at_fullsteps;
  const from = stage.left_at_fullsteps - margin * span;
  const to = stage.right_at_fullsteps + margin * span;
  const share = (at: number) => (at - from) / (to - from);
  return {
    from,
    to,
    left: share(stage.left_at_fullsteps),
    right: share(stage.right_at_fullsteps),
    refFrom: share(stage.ref_from_fullsteps),
    refTo: share(stage.ref_to_fullsteps),
  };
}

/**
 * Mechanical position [full steps] minus the chip's count in full steps: it changes when somebody sets the counter,
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
  place: (share: number) => void,
): void {
  const offset = useRef({ state: emulator, fullsteps: Number.NaN });
  useFrame(() => {
    const stage = emulator?.axes.find((candidate) => candidate.axis === axis);
    if (!stage) return;
    const geometry = geometryOf(stage.stage);
    const share = (fullsteps: number) => (fullsteps - geometry.from) / (geometry.to - geometry.from);
    if (microsteps === null) {
      place(share(stage.position_fullsteps));
      return;
    }
    if (offset.current.state !== emulator || Number.isNaN(offset.current.fullsteps)) {
      const next = countOffset(stage.position_fullsteps, emulator?.chip_time_s ?? 0, live, axis, microsteps);
      // Samples are 33 ms apart: what looks like a small change while it moves is only that.
      if (!(Math.abs(next - offset.current.fullsteps) < 40)) offset.current.fullsteps = next;
      offset.current.state = emulator;
    }
    const mechanical = live.read("position") / microsteps + offset.current.fullsteps;
    place(share(Number.isNaN(mechanical) ? stage.position_fullsteps : mechanical));
  });
}
