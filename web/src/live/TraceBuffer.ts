import { lowerBound } from "../plots/series";
import type { Frame } from "./frames";

/**
 * The latest `capacity` rows of some channels. Each column lies in an array of twice the capacity: rows are added at
 * the end, and once in `capacity` rows the newest half moves to the front. So what is kept is always one piece, to be
 * viewed without copying. Views are good until the next `append`.
 */
export class TraceBuffer {
  readonly channels: readonly string[];
  readonly capacity: number;
  /** counts changes: draw again when it differs from the one drawn */
  revision = 0;
  /** rows ever added: the absolute number of the row after the newest */
  total = 0;
  private end = 0;
  private readonly store: Float64Array[];
  private readonly columnOf: Map<string, number>;

  constructor(channels: readonly string[], capacity: number) {
    this.channels = channels;
    this.capacity = capacity;
    this.store = Array.from({ length: channels.length + 1 }, () => new Float64Array(2 * capacity));
    this.columnOf = new Map(channels.map((name, index) => [name, index + 1]));
  }

  get length(): number {
    return Math.min(this.end, this.capacity);
  }

  /** The device time of the newest row; NaN before the first. */
  get lastTime(): number {
    return this.end === 0 ? Number.NaN : (this.times()[this.length - 1] as number);
  }

  times(): Float64Array {
    return this.view(0);
  }

  /** The column of a channel, row by row with `times()`; null for a channel that is not kept. */
  column(channel: string): Float64Array | null {
    const index = this.columnOf.get(channel);
    return index === undefined ? null : this.view(index);
  }

  /** The newest value of a channel; NaN where there is none. */
  last(channel: string): number {
    const column = this.column(channel);
    return column === null || column.length === 0 ? Number.NaN : (column[column.length - 1] as number);
  }

  /** The value of a channel at a device time: of the last row not after it; NaN before the first. */
  at(channel: string, time: number): number {
    const column = this.column(channel);
    if (column === null) return Number.NaN;
    const row = lowerBound(this.times(), time);
    const exact = row < column.length && this.times()[row] === time;
    return (exact ? column[row] : column[row - 1]) ?? Number.NaN;
  }

  append(frame: Frame): void {
    if (frame.columns.length !== this.channels.length)
      throw new RangeError(`${frame.columns.length} columns for ${this.channels.length} channels`);
    // Time that goes back is another run of the device: what was before does not belong to the same axis of time.
    if (frame.rows > 0 && (frame.time[0] as number) < this.lastTime) this.clear();
    const skip = Math.max(0, frame.rows - this.capacity);
    const rows = frame.rows - skip;
    this.makeRoom(rows);
    [frame.time, ...frame.columns].forEach((source, index) => {
      this.store[index]?.set(skip === 0 ? source : source.subarray(skip), this.end);
    });
    this.end += rows;
    this.total += frame.rows;
    this.revision += 1;
  }

  /** Break every trace: a row of nothing just after the newest one. */
  gap(): void {
    const last = this.lastTime;
    if (Number.isNaN(last)) return;
    this.makeRoom(1);
    this.store.forEach((column, index) => {
      column[this.end] = index === 0 ? last : Number.NaN;
    });
    this.end += 1;
    this.total += 1;
    this.revision += 1;
  }

  clear(): void {
    this.end = 0;
    this.revision += 1;
  }

  /** A copy that no longer changes: what a paused scope looks at. */
  frozen(): TraceBuffer {
    const copy = new TraceBuffer(this.channels, Math.max(1, this.length));
    this.store.forEach((_, index) => {
      copy.store[index]?.set(this.view(index));
    });
    copy.end = this.length;
    copy.total = this.total;
    copy.revision = this.revision;
    return copy;
  }

  private makeRoom(rows: number): void {
    if (this.end + rows <= 2 * this.capacity) return;
    const keep = Math.min(this.length, this.capacity - Math.min(rows, this.capacity));
    for (const column of this.store) column.copyWithin(0, this.end - keep, this.end);
    this.end = keep;
  }

  private view(index: number): Float64Array {
    const column = this.store[index] as Float64Array;
    return column.subarray(this.end - this.length, this.end);
  }
}
