import { roundRange } from "../../plots/ranges";

/**
 * The range of a plot that is dragged on: it grows at once, but shrinks only when nothing is held. A plot that shrank
 * under the hand would run after it.
 */
export class CalmFrame {
  held = false;
  private low = Number.NaN;
  private high = Number.NaN;

  /** around 0: a braking slope is as large as an accelerating one */
  constructor(private readonly symmetric: boolean) {}

  next = (min: number, max: number): [number, number] => {
    const known = Number.isFinite(min) && Number.isFinite(max);
    if (!known) return Number.isNaN(this.low) ? [-1, 1] : [this.low, this.high];
    const size = Math.max(Math.abs(min), Math.abs(max));
    const [low, high] = this.symmetric ? roundRange(-size, size) : roundRange(Math.min(min, 0), Math.max(max, 0));
    if (Number.isNaN(this.low)) [this.low, this.high] = [low, high];
    const outside = low < this.low || high > this.high;
    const loose = high - low < (this.high - this.low) * 0.75;
    if (this.held && outside) [this.low, this.high] = [Math.min(low, this.low), Math.max(high, this.high)];
    else if (!this.held && (outside || loose)) [this.low, this.high] = [low, high];
    return [this.low, this.high];
  };
}

/**
 * A limit that is not reached is seen above the curve, unless it is so far away that the curve would be nothing: its
 * handle then waits at the edge.
 */
export function withHandles(min: number, max: number, heights: readonly number[]): [number, number] {
  const most = 2 * Math.max(Math.abs(min), Math.abs(max));
  const near = heights.filter((height) => Number.isFinite(height) && Math.abs(height) <= most);
  return [Math.min(0, min, ...near), Math.max(0, max, ...near)];
}
