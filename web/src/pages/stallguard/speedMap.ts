import type { TraceBuffer } from "../../live/TraceBuffer";
import { BinStats } from "../encoder/bins";

export const SPEED_BINS = 120;
/** Dots kept: the oldest make room. */
const MOST_DOTS = 3000;

/**
 * Load value and current scale against speed. Dots of the latest samples, and mean and spread per bin of speed of all
 * of them. The range of speed grows by doubling, so that bins join two by two and nothing has to be kept twice.
 */
export class SpeedMap {
  /** the speed at the end of the last bin [pps] */
  top: number;
  load: BinStats;
  scale: BinStats;
  lowest = new Float64Array(SPEED_BINS).fill(Number.POSITIVE_INFINITY);
  revision = 0;
  readonly dotSpeed = new Float64Array(MOST_DOTS);
  readonly dotLoad = new Float64Array(MOST_DOTS);
  readonly dotScale = new Float64Array(MOST_DOTS);
  private written = 0;
  private readTo = Number.NEGATIVE_INFINITY;

  constructor(readonly firstTop = 10_000) {
    this.top = firstTop;
    this.load = new BinStats(SPEED_BINS);
    this.scale = new BinStats(SPEED_BINS);
  }

  get dots(): number {
    return Math.min(this.written, MOST_DOTS);
  }

  /** `scale` may be NaN: a device that does not tell its current. */
  add(speed: number, load: number, scale: number): void {
    const size = Math.abs(speed);
    while (size >= this.top) this.double();
    const bin = Math.floor((size / this.top) * SPEED_BINS);
    this.load.add(bin, load);
    this.lowest[bin] = Math.min(this.lowest[bin] as number, load);
    if (!Number.isNaN(scale)) this.scale.add(bin, scale);
    const place = this.written % MOST_DOTS;
    this.dotSpeed[place] = size;
    this.dotLoad[place] = load;
    this.dotScale[place] = scale;
    this.written += 1;
  }

  private double(): void {
    const [load, scale] = [new BinStats(SPEED_BINS), new BinStats(SPEED_BINS)];
    const lowest = new Float64Array(SPEED_BINS).fill(Number.POSITIVE_INFINITY);
    for (let bin = 0; bin < SPEED_BINS; bin++) {
      const into = bin >> 1;
      load.take(into, this.load, bin);
      scale.take(into, this.scale, bin);
      lowest[into] = Math.min(lowest[into] as number, this.lowest[bin] as number);
    }
    this.load = load;
    this.scale = scale;
    this.lowest = lowest;
    this.top *= 2;
  }

  /** Take in the rows that have come since the last call: those in motion, with a speed and a load value. */
  read(buffer: TraceBuffer, channels: { speed: string; load: string; scale: string; velocity: string }): void {
    const times = buffer.times();
    const speed = buffer.column(channels.speed);
    const load = buffer.column(channels.load);
    const scale = buffer.column(channels.scale);
    // the driver measures a little speed at rest, too
    const velocity = buffer.column(channels.velocity);
    const newest = buffer.lastTime;
    if (speed === null || load === null || Number.isNaN(newest)) return;
    if (newest < this.readTo) this.readTo = Number.NEGATIVE_INFINITY; // the device has begun another life
    if (newest === this.readTo) return;
    let row = times.length;
    while (row > 0 && (times[row - 1] as number) > this.readTo) row--;
    for (; row < times.length; row++) {
      const [fast, value] = [speed[row] as number, load[row] as number];
      if (fast !== 0 && velocity?.[row] !== 0 && !Number.isNaN(fast + value))
        this.add(fast, value, scale?.[row] ?? Number.NaN);
    }
    this.readTo = newest;
    this.revision += 1;
  }

  clear(): void {
    this.load.clear();
    this.scale.clear();
    this.lowest.fill(Number.POSITIVE_INFINITY);
    this.top = this.firstTop;
    this.written = 0;
    this.revision += 1;
  }
}
