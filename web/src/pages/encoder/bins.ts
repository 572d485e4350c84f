/** Count, mean and spread of what fell into each of some bins, kept without the samples (Welford's recurrence). */
export class BinStats {
  readonly count: Float64Array;
  readonly mean: Float64Array;
  private readonly squares: Float64Array;

  constructor(readonly size: number) {
    this.count = new Float64Array(size);
    this.mean = new Float64Array(size);
    this.squares = new Float64Array(size);
  }

  add(bin: number, value: number): void {
    const count = (this.count[bin] as number) + 1;
    const before = this.mean[bin] as number;
    const mean = before + (value - before) / count;
    this.count[bin] = count;
    this.mean[bin] = mean;
    this.squares[bin] = (this.squares[bin] as number) + (value - before) * (value - mean);
  }

  /** Standard deviation within a bin; NaN below two values. */
  spread(bin: number): number {
    const count = this.count[bin] as number;
    return count < 2 ? Number.NaN : Math.sqrt((this.squares[bin] as number) / (count - 1));
  }

  /** Take over what bin `from` of another table holds, as if its values had been added here. */
  take(bin: number, other: BinStats, from: number): void {
    const theirs = other.count[from] as number;
    if (theirs === 0) return;
    const ours = this.count[bin] as number;
    const count = ours + theirs;
    const difference = (other.mean[from] as number) - (this.mean[bin] as number);
    this.count[bin] = count;
    this.mean[bin] = (this.mean[bin] as number) + (difference * theirs) / count;
    this.squares[bin] =
      (this.squares[bin] as number) +
      (other.squares[from] as number) +
      (difference * difference * ours * theirs) / count;
  }

  get total(): number {
    return this.count.reduce((sum, value) => sum + value, 0);
  }

  /** The share of bins that hold anything, 0..1. */
  get covered(): number {
    return this.count.reduce((sum, value) => sum + (value > 0 ? 1 : 0), 0) / this.size;
  }

  clear(): void {
    this.count.fill(0);
    this.mean.fill(0);
    this.squares.fill(0);
  }
}

/** Several tables as one of `size` bins; neighbouring bins of the sources join where it has fewer. */
export function joined(sources: readonly BinStats[], size: number): BinStats {
  const result = new BinStats(size);
  for (const source of sources) {
    const each = source.size / size;
    for (let bin = 0; bin < source.size; bin++) result.take(Math.floor(bin / each), source, bin);
  }
  return result;
}

/** The bin of an angle: `value` modulo `period`, in `bins` equal parts, also for negative values. */
export function binOf(value: number, period: number, bins: number): number {
  const share = value / period - Math.floor(value / period);
  return Math.min(bins - 1, Math.floor(share * bins));
}
