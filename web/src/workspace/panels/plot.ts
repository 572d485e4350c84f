/** What a plot in a panel of its own shows. */
export interface PlotConfig {
  /** channels by path, `$:` those of the panel's axis; an XY plot is over the first. None: those of its kind */
  y: string[];
  /** [s]; 0: the scope's time */
  spanS: number;
}

export function readPlot({ y, spanS }: Readonly<Record<string, unknown>>): PlotConfig {
  return {
    y: Array.isArray(y) ? y.filter((path) => typeof path === "string").slice(0, 8) : [],
    spanS: typeof spanS === "number" && spanS > 0 && spanS <= 300 ? spanS : 0,
  };
}
