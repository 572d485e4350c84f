import type { Device } from "../../api/queries";
import type { Kind } from "./answer";

/** What of a motion is asked for: quantities measured, and as the driver expects them, that the device offers. */
export function channelsOf(device: Pick<Device, "channels">, axis: number, kinds: readonly Kind[]): string[] {
  const offered = new Set(device.channels.map((channel) => channel.name));
  return [...kinds, ...kinds.map((kind) => `predicted_${kind}`)]
    .map((quantity) => `${quantity}.${axis}`)
    .filter((name) => offered.has(name));
}

/** Whether a motion went against `way`: the way back of a there-and-back, to be laid over the way there. */
export function mirrored(velocity: ArrayLike<number>, way: 1 | -1): boolean {
  let sum = 0;
  for (let row = 0; row < velocity.length; row++) {
    const value = velocity[row] as number;
    if (!Number.isNaN(value)) sum += value;
  }
  return sum * way < 0;
}

/** Rows of so many, evenly, with the first and the last: enough to see where something is. */
export function thinned(length: number, most: number): number[] {
  if (length <= most) return Array.from({ length }, (_, row) => row);
  return Array.from({ length: most }, (_, index) => Math.round((index * (length - 1)) / (most - 1)));
}

/** The first number of a column; 0 where there is none. */
export function firstOf(values: ArrayLike<number>): number {
  for (let row = 0; row < values.length; row++) {
    const value = values[row] as number;
    if (!Number.isNaN(value)) return value;
  }
  return 0;
}
