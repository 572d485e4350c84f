/** What a count of the current scale (0..31, of the driver) is worth: a count of n stands for (n + 1) of it. */
export interface CurrentScale {
  /** in a legend */
  name: string;
  step: number;
  /** the run current that is set; NaN while unknown */
  run: number;
  /** beside a number, and on an axis */
  unit: string;
  symbol: string;
  decimals: number;
  /** where nothing is known of the run current [as `step`] */
  most: number;
  /** a second axis tells the share of the run current */
  shares: boolean;
}

export function currentOf(scale: number, { step }: CurrentScale): number {
  return step * (scale + 1);
}

/** The top of an axis of currents. */
export function topOf({ run, most }: CurrentScale): number {
  return Number.isFinite(run) && run > 0 ? run * 1.1 : most;
}
