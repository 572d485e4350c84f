import type { Comparison } from "./api";
import type { Channel } from "./channels";

/** Recordings are told apart by their dashes: a channel keeps its colour. */
export const SIDE_DASHES: readonly number[][] = [
  [],
  [7, 4],
  [2, 3],
  [10, 3, 2, 3],
  [4, 2, 1, 2],
  [14, 4],
  [1, 4],
  [6, 2],
];

/** The channels of a comparison as those of a recording are. */
export function channelsOf(comparison: Comparison): Channel[] {
  return comparison.channels.map(({ channel, unit }) => {
    const at = channel.lastIndexOf(".");
    return { name: channel, quantity: channel.slice(0, at), axis: Number(channel.slice(at + 1)) || 0, unit };
  });
}

/** The ids in `?of=a,b`; each once. */
export function idsOf(search: string): string[] {
  const text = new URLSearchParams(search).get("of") ?? "";
  return [...new Set(text.split(",").filter((id) => /^[0-9]{8}-[0-9]{6}-[0-9a-f]{4}$/.test(id)))];
}
