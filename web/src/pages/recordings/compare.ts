import type { Comparison } from "./api";
import type { Channel } from "./channels";

interface Look {
  color: string;
  dash: number[];
}

/** Okabe and Ito's colours, with dashes for who cannot tell them apart. The first is that of the recording itself. */
const SIDES: readonly (readonly [light: string, dark: string, dash: number[]])[] = [
  ["#0068a8", "#56b4e9", []],
  ["#b85c00", "#f0a03c", [7, 4]],
  ["#008060", "#a6e36a", [2, 3]],
  ["#6a0f5c", "#e65fb0", [10, 3, 2, 3]],
  ["#4b2fa3", "#8f7bff", [4, 2, 1, 2]],
  ["#5c5200", "#f0e442", [14, 4]],
  ["#5b6470", "#aab2bd", [1, 4]],
  ["#8c5a3c", "#cf9a78", [6, 2]],
];

/** The names of these colours, by which a recording has one of its own. */
export const COLOURS = ["blue", "orange", "green", "pink", "violet", "olive", "grey", "brown"] as const;

/** How the recording at this place of a comparison is drawn, in all its channels; in its own colour where it has one. */
export function sideLook(index: number, scheme: "light" | "dark", colour = ""): Look {
  const [, , dash] = SIDES[index % SIDES.length] as (typeof SIDES)[number];
  const own = (COLOURS as readonly string[]).indexOf(colour);
  const [light, dark] = SIDES[(own < 0 ? index : own) % SIDES.length] as (typeof SIDES)[number];
  return { color: scheme === "dark" ? dark : light, dash };
}

/** The channels of a comparison as those of a recording are. */
export function channelsOf(comparison: Comparison): Channel[] {
  return comparison.channels.map(({ channel, unit }) => {
    // of a file of another instrument it has no axis
    const [, quantity, axis] = /^(.+)\.(\d+)$/.exec(channel) ?? ["", channel, 0];
    return { name: channel, quantity: quantity ?? channel, axis: Number(axis), unit };
  });
}

/** The ids in `?of=a,b`; each once. */
export function idsOf(search: string): string[] {
  const text = new URLSearchParams(search).get("of") ?? "";
  return [...new Set(text.split(",").filter((id) => /^[0-9]{8}-[0-9]{6}-[0-9a-f]{4}$/.test(id)))];
}
