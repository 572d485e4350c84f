import type { Look } from "./observed";

export interface SeenEdge {
  which: "left" | "right" | "home";
  /** it became active, not inactive */
  closed: boolean;
  /** [full steps] of the counter */
  at: number;
}

const SWITCHES = ["left", "right", "home"] as const;

/** The switch edges of one reference search, as the samples show them: a module tells only of its result. */
export class EdgeTrail {
  edges: SeenEdge[] = [];
  revision = 0;
  /** device time up to which samples were looked at [s] */
  lookedAtS = Number.NEGATIVE_INFINITY;
  private before: Look | null = null;

  /** A search begins; what was sampled before `atS` is none of it. */
  begin(atS: number): void {
    this.edges = [];
    this.before = null;
    this.lookedAtS = atS;
    this.revision += 1;
  }

  look(now: Look): void {
    const { before } = this;
    if (Number.isNaN(now.position) || (before !== null && now.timeS <= before.timeS)) return;
    this.before = now;
    this.lookedAtS = now.timeS;
    if (before === null) return;
    for (const which of SWITCHES) {
      const [was, is] = [before[which] > 0.5, now[which] > 0.5];
      if (Number.isNaN(before[which] + now[which]) || was === is) continue;
      this.edges.push({ which, closed: is, at: (before.position + now.position) / 2 });
      this.revision += 1;
    }
  }

  /** The search has made `zero` of the old counting its new zero [full steps]: the edges are where they were. */
  end(zero: number): void {
    this.edges = this.edges.map((edge) => ({ ...edge, at: edge.at - zero }));
    this.before = null;
    this.revision += 1;
  }
}
