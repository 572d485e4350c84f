import { api, type Schemas } from "../../api/client";

type Frame = Schemas["FrameEntry"];

export const FRAMES = 1000;
/** how long it may take in all [s]: a module at 9600 baud answers 60 frames a second */
const WITHIN_S = 10;

export interface LinkFigures {
  sent: number;
  /** frames without a good answer */
  lost: number;
  /** round trip of those that were answered [ms]; null where none was */
  medianMs: number | null;
  p99Ms: number | null;
}

/** What frames tell of the wire that they went over. */
export function figuresOfFrames(frames: readonly Pick<Frame, "took_ms" | "error">[]): LinkFigures {
  const took = frames.filter(({ error }) => error === null).map(({ took_ms }) => took_ms);
  took.sort((one, other) => one - other);
  const at = (share: number) => took[Math.ceil(share * took.length) - 1] ?? null;
  return { sent: frames.length, lost: frames.length - took.length, medianMs: at(0.5), p99Ms: at(0.99) };
}

/** Read all registers again and again until so many frames have gone over the wire, or the time is over. */
export async function tryLink(device: string, told: (share: number) => void): Promise<LinkFigures> {
  const path = { device };
  let { next } = await api.GET("/api/v1/devices/{device}/frames", { path, query: { limit: 1 } });
  const began = performance.now();
  const frames: Frame[] = [];
  let failure: unknown = null;
  while (frames.length < FRAMES && performance.now() - began < WITHIN_S * 1000 && failure === null) {
    // a frame that failed ends the reading of the others: it is counted, and told where nothing else is
    failure = await api.GET("/api/v1/devices/{device}/registers", { path }).then(
      () => null,
      (error: unknown) => error,
    );
    const log = await api.GET("/api/v1/devices/{device}/frames", { path, query: { after: next, limit: 2000 } });
    next = log.next;
    frames.push(...log.frames);
    if (failure !== null && log.frames.some(({ error }) => error !== null)) failure = null;
    told(Math.min(1, frames.length / FRAMES));
  }
  if (failure !== null) throw failure;
  return figuresOfFrames(frames);
}
