import type { TelemetrySource } from "../../../live/TelemetrySource";
import type { TraceBuffer } from "../../../live/TraceBuffer";
import type { Trigger } from "./settings";

/** The share of the span that is seen before a trigger, and ahead of the newest sample while rolling. */
const BEFORE_TRIGGER = 0.1;
const AHEAD = 0.02;
/** A step of the newest sample's time beyond this is no jitter: jump there [s]. */
const JUMP_S = 0.4;

export interface CursorPair {
  a: number;
  b: number;
}

interface Frozen {
  copy: TraceBuffer;
  live: TraceBuffer;
}

function frozenOf({ buffer }: TelemetrySource): Frozen {
  return { copy: buffer.frozen(), live: buffer };
}

/**
 * Which stretch of time the scope shows, and of which samples. Not React state: it changes in every frame. Times are
 * those of the main source's device [s].
 */
export class ScopeView {
  spanS: number;
  trigger: Trigger;
  paused = false;
  /** the measuring cursors: places 0..1 in the window while it moves, times once it stands */
  private cursorPlaces: CursorPair = { a: 1 / 3, b: 2 / 3 };
  private cursorTimes: CursorPair | null = null;
  private window: [number, number] = [0, 1];
  private frozen = new Map<TelemetrySource, Frozen>();
  private triggeredAt: number | null = null;
  private armed = true;
  private smoothEnd = Number.NaN;
  private lastMs = Number.NaN;
  /** counts changes of the view by hand */
  revision = 0;

  constructor(spanS: number, trigger: Trigger) {
    this.spanS = spanS;
    this.trigger = trigger;
  }

  /** The samples to show of a source: the live ones, or those of the moment of the pause. */
  bufferOf(source: TelemetrySource): TraceBuffer {
    if (!this.paused) return source.buffer;
    const frozen = this.frozen.get(source);
    if (frozen?.live === source.buffer) return frozen.copy;
    // what is wanted since the pause has its past in another buffer
    this.frozen.set(source, frozenOf(source));
    return this.bufferOf(source);
  }

  pause(sources: readonly TelemetrySource[], window?: readonly [number, number]): void {
    if (!this.paused) {
      // no frame has followed the signal yet
      if (Number.isNaN(this.smoothEnd)) this.next(sources[0]?.buffer.lastTime ?? Number.NaN, performance.now());
      this.frozen = new Map(sources.map((source) => [source, frozenOf(source)]));
      this.cursorTimes = this.cursors();
      this.paused = true;
    }
    if (window) this.window = [...window];
    this.revision += 1;
  }

  run(): void {
    if (this.paused && this.cursorTimes) this.cursorPlaces = { a: 1 / 3, b: 2 / 3 };
    this.paused = false;
    this.cursorTimes = null;
    this.frozen.clear();
    this.triggeredAt = null;
    this.armed = true;
    this.smoothEnd = Number.NaN;
    this.revision += 1;
  }

  /** A new time base or trigger: a waiting or caught sweep begins anew. */
  set(spanS: number, trigger: Trigger): void {
    if (trigger !== this.trigger) {
      this.triggeredAt = null;
      this.armed = true;
    }
    if (this.paused && spanS !== this.spanS) {
      const middle = (this.window[0] + this.window[1]) / 2;
      this.window = [middle - spanS / 2, middle + spanS / 2];
    }
    this.spanS = spanS;
    this.trigger = trigger;
    this.revision += 1;
  }

  /** A move has started: the sweep of a waiting trigger begins. A sweep that runs is not cut off. */
  onMove(startedAtS: number, newestS: number): void {
    if (this.paused || this.trigger === "roll" || !this.armed) return;
    const running = this.triggeredAt !== null && newestS < this.triggeredAt + this.spanS * (1 - BEFORE_TRIGGER);
    if (!running) this.triggeredAt = startedAtS;
  }

  get waiting(): boolean {
    return !this.paused && this.trigger !== "roll" && this.triggeredAt === null;
  }

  /** When the move began that the sweep on show was triggered by; null while rolling or waiting. */
  get triggerTime(): number | null {
    return this.triggeredAt;
  }

  /** The window for this frame. `true` as third: a single sweep is complete and the scope should pause now. */
  next(newestS: number, nowMs: number): { window: [number, number]; complete: boolean } {
    if (this.paused) return { window: this.window, complete: false };
    if (this.trigger !== "roll" && this.triggeredAt !== null) {
      const start = this.triggeredAt - this.spanS * BEFORE_TRIGGER;
      this.window = [start, start + this.spanS];
      return { window: this.window, complete: this.trigger === "single" && newestS >= start + this.spanS };
    }
    const end = this.follow(newestS, nowMs) + this.spanS * AHEAD;
    this.window = [end - this.spanS, end];
    return { window: this.window, complete: false };
  }

  /** The end of a rolling window: samples come in batches, and the trace should glide all the same. */
  private follow(newestS: number, nowMs: number): number {
    if (Number.isNaN(newestS)) return 0;
    const elapsed = (nowMs - this.lastMs) / 1000;
    this.lastMs = nowMs;
    const glided = this.smoothEnd + elapsed;
    const off = newestS - glided;
    this.smoothEnd = !(Math.abs(off) < JUMP_S) ? newestS : glided + off * 0.08;
    return this.smoothEnd;
  }

  current(): readonly [number, number] {
    return this.window;
  }

  cursors(): CursorPair {
    if (this.cursorTimes) return this.cursorTimes;
    const [from, to] = this.window;
    return { a: from + this.cursorPlaces.a * (to - from), b: from + this.cursorPlaces.b * (to - from) };
  }

  moveCursor(id: "a" | "b", time: number): void {
    const [from, to] = this.window;
    if (this.cursorTimes) this.cursorTimes = { ...this.cursorTimes, [id]: time };
    else this.cursorPlaces = { ...this.cursorPlaces, [id]: (time - from) / (to - from) };
    this.revision += 1;
  }

  /** Where the cursors of a picture that stands are. */
  setCursors(cursors: CursorPair): void {
    if (this.cursorTimes) this.cursorTimes = cursors;
    this.revision += 1;
  }

  /** Bring cursors back that a zoom has left outside of the window. */
  fetchCursors(): void {
    const [from, to] = this.window;
    const at = (share: number) => from + share * (to - from);
    if (this.cursorTimes) this.cursorTimes = { a: at(1 / 3), b: at(2 / 3) };
    else this.cursorPlaces = { a: 1 / 3, b: 2 / 3 };
    this.revision += 1;
  }
}
