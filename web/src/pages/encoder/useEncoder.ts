import { useMemo, useRef } from "react";
import type { Device } from "../../api/queries";
import type { Quantity } from "../../lib/palette";
import type { TelemetrySource } from "../../live/TelemetrySource";
import { useFrame } from "../../live/useFrame";
import { AngleMap } from "./angleMap";

export type Which = "internal" | "external";

export interface EncoderChannels {
  position: Quantity;
  deviation: Quantity;
}

export const ENCODERS: Record<Which, EncoderChannels & { label: string }> = {
  internal: { position: "encoder_position", deviation: "deviation", label: "Internal" },
  external: { position: "external_encoder_position", deviation: "external_deviation", label: "External" },
};

/** What an encoder is called among those that there are: the only one has no other name. */
export function encoderName(which: Which, among: readonly Which[]): string {
  return among.length > 1 ? `${ENCODERS[which].label} encoder` : "Encoder";
}

/** Which encoders a device tells of, on that axis. */
export function encodersOf(device: Device, axis: number): Which[] {
  return (["internal", "external"] as const).filter((which) =>
    device.channels.some((channel) => channel.name === `${ENCODERS[which].deviation}.${axis}`),
  );
}

/** What has to be sampled: on a wire every channel costs a question, so none that is not looked at. */
export function channelsFor(device: Device, axis: number, shown: readonly Which[]): string[] {
  const wanted: Quantity[] = [
    "position",
    "velocity",
    ...shown.flatMap((which) => [ENCODERS[which].position, ENCODERS[which].deviation]),
  ];
  return wanted
    .map((quantity) => `${quantity}.${axis}`)
    .filter((name) => device.channels.some((channel) => channel.name === name));
}

/** Maps of both encoders that take in every sample; new ones when the motor is another, or counts otherwise. */
export function useAngleMaps(
  source: TelemetrySource,
  axis: number,
  fullStepsPerTurn: number,
  microstepsPerFullStep: number,
): Record<Which, AngleMap> {
  const device = source.request.device;
  // biome-ignore lint/correctness/useExhaustiveDependencies: another device's turns are not this one's
  const maps = useMemo(
    () => ({
      internal: new AngleMap(fullStepsPerTurn, microstepsPerFullStep),
      external: new AngleMap(fullStepsPerTurn, microstepsPerFullStep),
    }),
    [device, axis, fullStepsPerTurn, microstepsPerFullStep],
  );
  const seen = useRef(-1);
  useFrame(() => {
    if (seen.current === source.buffer.revision) return;
    seen.current = source.buffer.revision;
    for (const which of ["internal", "external"] as const)
      maps[which].read(source.buffer, {
        position: `position.${axis}`,
        velocity: `velocity.${axis}`,
        deviation: `${ENCODERS[which].deviation}.${axis}`,
      });
  });
  return maps;
}

/** Calls `draw` at most five times a second, and only when one of the maps has changed or `key` has. */
export function useMapChanges(maps: readonly AngleMap[], key: string, draw: () => void): void {
  const drawn = useRef("");
  const lastMs = useRef(Number.NEGATIVE_INFINITY);
  useFrame((nowMs) => {
    if (nowMs - lastMs.current < 200) return;
    const state = `${maps.map((map) => map.revision).join()} ${key}`;
    if (state === drawn.current) return;
    drawn.current = state;
    lastMs.current = nowMs;
    draw();
  });
}
