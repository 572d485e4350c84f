import { api } from "../../api/client";
import { motion } from "../../api/motion";
import type { Device } from "../../api/queries";
import { scaleOf, toSteps } from "../../lib/units";
import { geometryOf } from "./carriage";
import { type EmulatedAxis, emulatedAxis } from "./emulation";

/** The share of the stage, from the left switch, between which an axis goes back and forth: each its own. */
const STRETCHES: readonly (readonly [number, number])[] = [
  [0.12, 0.88],
  [0.3, 0.75],
  [0.4, 0.92],
];
const TURNS_WITHOUT_STAGE = 3;

/** Both ends of an axis's way in its own microsteps, for a carriage that stands at `count` now. */
export function stretchOf(stage: EmulatedAxis, count: number, microstepsPerFullStep: number): [number, number] {
  const { from, to, left, right } = geometryOf(stage.places);
  const [low, high] = STRETCHES[stage.axis % STRETCHES.length] ?? [0.2, 0.8];
  const offset = stage.positionFullsteps - count / microstepsPerFullStep;
  const place = (share: number) => {
    const fullsteps = from + (left + share * (right - left)) * (to - from);
    return Math.round((fullsteps - offset) * microstepsPerFullStep);
  };
  return [place(low), place(high)];
}

async function startDevice(device: Device): Promise<void> {
  const emulator = await api.GET("/api/v1/devices/{device}/emulator", { path: { device: device.id } });
  for (const axis of device.axes) {
    const at = { device: device.id, axis: axis.index };
    const state = await api.GET("/api/v1/devices/{device}/axes/{axis}", { path: at });
    const scale = scaleOf(axis, device.clock_hz);
    const stage = emulatedAxis(emulator, axis.index);
    const turn = toSteps(1, "rev", scale, "position") || 12_800;
    const [first, second] =
      stage && scale.microstepsPerFullStep
        ? stretchOf(stage, state.position, scale.microstepsPerFullStep)
        : [state.position, state.position + TURNS_WITHOUT_STAGE * turn];
    await motion.shuttle(at, { first, second, dwell_s: 0.3 + 0.15 * axis.index });
  }
}

/** Sets every axis of the demo devices going, each between two places of its stage. */
export async function startDemo(devices: readonly Device[]): Promise<void> {
  await Promise.all(devices.map(startDevice));
}

export async function endDemo(devices: readonly Device[]): Promise<void> {
  await Promise.all(
    devices.flatMap((device) => device.axes.map((axis) => motion.endShuttle({ device: device.id, axis: axis.index }))),
  );
}
