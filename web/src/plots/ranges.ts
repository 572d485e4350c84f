/** 1, 2 or 5 times a power of ten, not below `value`. */
function niceAbove(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const lead = value / power;
  return (lead <= 1 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10) * power;
}

/** The range that holds min..max with a little air, on round numbers. */
export function roundRange(min: number, max: number): [number, number] {
  if (!(Number.isFinite(min) && Number.isFinite(max))) return [-1, 1];
  const size = max - min;
  if (size <= Math.abs(max) * 1e-12) {
    const air = Math.max(1, niceAbove(Math.abs(max) * 0.05 || 1));
    return [min - air, max + air];
  }
  const step = niceAbove(size / 12);
  return [Math.floor((min - size * 0.02) / step) * step, Math.ceil((max + size * 0.02) / step) * step];
}

/**
 * A range that stands still: it grows at once when the data leave it, and shrinks only when they fill less than
 * `fill` of it. A trace that scrolls by would else make its axis tremble.
 */
export class CalmRange {
  private low = Number.NaN;
  private high = Number.NaN;
  constructor(private readonly fill = 0.6) {}

  next(min: number, max: number): [number, number] {
    if (!(Number.isFinite(min) && Number.isFinite(max)))
      return Number.isNaN(this.low) ? [-1, 1] : [this.low, this.high];
    const [low, high] = roundRange(min, max);
    const outside = !(min >= this.low && max <= this.high);
    if (outside || high - low < (this.high - this.low) * this.fill) {
      this.low = low;
      this.high = high;
    }
    return [this.low, this.high];
  }
}

/** How many decimals tell ticks of this distance apart: 2.5 needs one, 20 none. */
export function decimalsOf(increment: number): number {
  for (let decimals = 0; decimals < 12; decimals++) {
    const scaled = increment * 10 ** decimals;
    if (Math.abs(scaled - Math.round(scaled)) < 1e-6 * scaled) return decimals;
  }
  return 12;
}
