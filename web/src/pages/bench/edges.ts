import type { Look } from "./observed";

export interface SeenEdge {
  which: "left" | "right" | "home";
  /** it became active, not inactive */
  closed: boolean;
  /** [full steps] of the counter */
  at: number;
}

const SWITCHES = ["left", "right", "home"] as const;
/** Samples of a search may come so much later than the answer that it is done [s]. */
const SAMPLES_LATE_S = 1;

/** The switch edges of one reference search, as the samples show them: a module tells only of its result. */
export class EdgeTrail {
  edges: SeenEdge[] = [];
  revision = 0;
  /** device time up to which samples were looked at [s] */
  lookedAtS = Number.NEGATIVE_INFINITY;
  private before: Look | null = null;
  /** of the search that is done while its last samples may still come, and until when they may [full steps], [s] */
  private last: { zero: number; untilS: number } | null = null;

  /** A search begins; what was sampled before `atS` is none of it. */
  begin(atS: number): void {
    this.edges = [];
    this.before = null;
    this.last = null;
    this.lookedAtS = atS;
    this.revision += 1;
  }

  look(now: Look): void {
    const { before } = this;
    if (Number.isNaN(now.position) || (before !== null && now.timeS <= before.timeS)) return;
    this.before = now;
    this.lookedAtS = now.timeS;
    if (before === null) return;
    const zeroed = this.last !== null && isZeroed(now.position - before.position, this.last.zero);
    for (const which of SWITCHES) {
      const [was, is] = [before[which] > 0.5, now[which] > 0.5];
      if (Number.isNaN(before[which] + now[which]) || was === is) continue;
      this.edges.push({ which, closed: is, at: zeroed ? before.position : (before.position + now.position) / 2 });
      this.revision += 1;
    }
    if (this.last !== null && (zeroed || now.timeS > this.last.untilS)) this.end(this.last.zero);
  }

  /** The search is done: `zero` of the old counting is its new zero [full steps]. Its last samples may still come. */
  finish(zero: number): void {
    this.last = { zero, untilS: this.lookedAtS + SAMPLES_LATE_S };
  }

  /** Whether samples of a search that is done may still come. */
  get finishing(): boolean {
    return this.last !== null;
  }

  /** Samples count from `zero` now: the edges are where they were. */
  private end(zero: number): void {
    this.edges = this.edges.map((edge) => ({ ...edge, at: edge.at - zero }));
    this.before = null;
    this.last = null;
    this.revision += 1;
  }
}

/** Whether the counter was set anew on a way that the samples show, `zero` becoming 0. */
function isZeroed(way: number, zero: number): boolean {
  return way * Math.sign(zero) < -Math.abs(zero) / 2;
}
