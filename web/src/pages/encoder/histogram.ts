/** More classes than this are joined two by two: a lost turn must not make a million of them. */
const MOST_CLASSES = 1024;

export interface Bar {
  from: number;
  to: number;
  count: number;
}

/** How often each value came, and mean, rms and peak of all of them, exactly. */
export class Histogram {
  count = 0;
  /** the value furthest from 0, with its sign; NaN before the first */
  peak = Number.NaN;
  private sum = 0;
  private squares = 0;
  /** width of a class: 1, 2, 4 ... */
  private width = 1;
  private classes = new Map<number, number>();

  add(value: number): void {
    this.count += 1;
    this.sum += value;
    this.squares += value * value;
    if (!(Math.abs(value) <= Math.abs(this.peak))) this.peak = value;
    this.put(Math.floor(value / this.width), 1);
  }

  private put(index: number, count: number): void {
    this.classes.set(index, (this.classes.get(index) ?? 0) + count);
    while (this.classes.size > MOST_CLASSES) this.widen();
  }

  private widen(): void {
    this.width *= 2;
    const old = this.classes;
    this.classes = new Map();
    for (const [index, count] of old) {
      const into = Math.floor(index / 2);
      this.classes.set(into, (this.classes.get(into) ?? 0) + count);
    }
  }

  take(other: Histogram): void {
    if (other.count === 0) return;
    this.count += other.count;
    this.sum += other.sum;
    this.squares += other.squares;
    if (!(Math.abs(other.peak) <= Math.abs(this.peak))) this.peak = other.peak;
    while (this.width < other.width) this.widen();
    for (const [index, count] of other.classes) this.put(Math.floor((index * other.width) / this.width), count);
  }

  get mean(): number {
    return this.sum / this.count;
  }

  get rms(): number {
    return Math.sqrt(this.squares / this.count);
  }

  /** Standard deviation about the mean. */
  get spread(): number {
    return Math.sqrt(Math.max(0, this.squares / this.count - this.mean ** 2));
  }

  /** At most `most` bars of equal width, a power of two, without holes from the first to the last value. */
  bars(most = 60): Bar[] {
    if (this.count === 0) return [];
    const indexes = [...this.classes.keys()];
    const first = Math.min(...indexes) * this.width;
    const last = (Math.max(...indexes) + 1) * this.width;
    let width = this.width;
    while ((last - first) / width > most - 1) width *= 2;
    const start = Math.floor(first / width);
    const bars = Array.from({ length: Math.ceil(last / width) - start }, (_, index) => ({
      from: (start + index) * width,
      to: (start + index + 1) * width,
      count: 0,
    }));
    for (const [index, count] of this.classes) {
      const bar = bars[Math.floor((index * this.width) / width) - start];
      if (bar) bar.count += count;
    }
    return bars;
  }

  clear(): void {
    this.count = 0;
    this.sum = 0;
    this.squares = 0;
    this.peak = Number.NaN;
    this.width = 1;
    this.classes.clear();
  }
}
