import type { Schemas } from "../../../api/client";
import { compact } from "../../../lib/format";
import type { PlotData } from "../../../plots/series";

export type Loop = Schemas["LoopFound"];

/** Gain [dB] and phase [°] over the logarithm of the frequency. */
export function bodeOf({ open_loop: loop }: Loop): PlotData {
  return [loop.frequency_hz.map(Math.log10), loop.gain_db, loop.phase_deg];
}

/** Names of ticks of a logarithm. */
export function tensTicks(values: number[]): string[] {
  return values.map((value) => compact(10 ** value, 2));
}

/** Gain [dB] over phase [°], which turns back: the curve itself, and columns that span what it covers. */
export function nicholsOf({ open_loop: { phase_deg: phase, gain_db: gain } }: Loop) {
  const data: PlotData = [
    [Math.min(...phase), Math.max(...phase)],
    [Math.min(...gain), Math.max(...gain)].map(() => null),
  ];
  return { phase, gain, data };
}
