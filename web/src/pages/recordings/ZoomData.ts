/** A stretch of a recording as points: its extremes, or (`exact`) its very samples. */
export interface Piece {
  from: number;
  to: number;
  x: Float64Array;
  columns: readonly Float64Array[];
  exact: boolean;
}

export type Window = readonly [from: number, to: number];

/** Points for each pixel that a plot should have, and how many at the most it asks for. */
const DENSITY = 2;
const POINTS_MAX = 20_000;
const KEPT = 12;

/**
 * What a plot that zooms draws: at once the best there is, and what is missing is fetched meanwhile, one piece at a
 * time and always for where the plot is then. A piece is asked for wider than the window, so that panning finds it there.
 */
export class ZoomData {
  private pieces: Piece[] = [];
  private whole: Piece | null = null;
  private wanted: { window: Window; pixels: number } | null = null;
  private busy = false;
  private ended = false;
  /** why the last fetch failed, until one succeeds */
  problem: unknown = null;

  constructor(
    private readonly fetch: (window: Window | null, points: number) => Promise<Piece>,
    private readonly onChange: () => void,
  ) {}

  get overview(): Piece | null {
    return this.whole;
  }

  /** The whole of it, anew for a recording that has grown. */
  async load(points: number): Promise<void> {
    this.ended = false; // a page may come back to it
    await this.run(async () => {
      const whole = await this.fetch(null, points);
      // Pieces of before end where the recording ended then: those that reach it know less than there is now.
      const end = this.whole?.x.at(-1) ?? Number.POSITIVE_INFINITY;
      this.pieces = this.pieces.filter((piece) => piece.to < end);
      this.whole = whole;
    });
    this.next();
  }

  /** The finest piece that covers the window. */
  best([from, to]: Window): Piece | null {
    let best = this.whole;
    for (const piece of this.pieces)
      if (piece.from <= from && piece.to >= to && (best === null || density(piece) > density(best))) best = piece;
    return best;
  }

  /** The plot shows this part, so many pixels wide. */
  show(window: Window, pixels: number): void {
    this.wanted = { window, pixels };
    this.next();
  }

  end(): void {
    this.ended = true;
  }

  private next(): void {
    const { wanted } = this;
    if (wanted === null || this.busy || this.ended || this.whole === null) return;
    const { window, pixels } = wanted;
    const best = this.best(window);
    if (best === null || good(best, window, pixels)) return;
    const margin = (window[1] - window[0]) / 2;
    const wide: Window = [window[0] - margin, window[1] + margin];
    void this.run(async () => {
      const piece = await this.fetch(wide, Math.min(POINTS_MAX, Math.ceil(pixels * DENSITY * 2)));
      this.pieces = [piece, ...this.pieces].slice(0, KEPT);
    }).then(() => {
      if (this.problem === null) this.next();
    });
  }

  private async run(work: () => Promise<void>): Promise<void> {
    this.busy = true;
    try {
      await work();
      this.problem = null;
    } catch (error) {
      this.problem = error;
    }
    this.busy = false;
    if (!this.ended) this.onChange();
  }
}

function spanOf({ from, to, x }: Piece): number {
  const first = Number.isFinite(from) ? from : (x[0] ?? 0);
  const last = Number.isFinite(to) ? to : (x.at(-1) ?? 0);
  return Math.max(last - first, Number.MIN_VALUE);
}

function density(piece: Piece): number {
  return piece.exact ? Number.POSITIVE_INFINITY : piece.x.length / spanOf(piece);
}

/** Whether a plot of so many pixels would look no better with a finer one. */
export function good(piece: Piece, [from, to]: Window, pixels: number): boolean {
  return piece.exact || density(piece) * (to - from) >= 0.9 * pixels;
}
