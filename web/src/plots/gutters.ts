import type uPlot from "uplot";

/** What axes and labels of one plot need beside its drawing area [px]. */
interface Need {
  left: number;
  right: number;
}

/**
 * The gutters of a stack of plots: each is as wide as the widest that any of them needs, so the same x lies on one
 * vertical line in all. They grow with the labels and do not shrink again: nothing trembles while data pass.
 */
export class Gutters<Member> {
  private readonly needs = new Map<Member, Need>();

  constructor(private readonly layOut: (member: Member) => void) {}

  /** Takes what `member` needs now, and has the others laid out anew where that widens a gutter. */
  claim(member: Member, need: Need): void {
    const before = { left: this.left, right: this.right };
    const own = this.needs.get(member) ?? { left: 0, right: 0 };
    this.needs.set(member, { left: Math.max(own.left, need.left), right: Math.max(own.right, need.right) });
    if (this.left === before.left && this.right === before.right) return;
    for (const other of this.needs.keys()) if (other !== member) this.layOut(other);
  }

  leave(member: Member): void {
    this.needs.delete(member);
  }

  get left(): number {
    return Math.max(0, ...[...this.needs.values()].map(({ left }) => left));
  }

  get right(): number {
    return Math.max(0, ...[...this.needs.values()].map(({ right }) => right));
  }
}

const stacks = new Map<string, Gutters<uPlot>>();

/** The gutters of the plots that name this stack; without a name of a plot alone. */
export function guttersOf(stack: string | undefined): Gutters<uPlot> {
  const known = stack === undefined ? undefined : stacks.get(stack);
  if (known) return known;
  const made = new Gutters<uPlot>((plot) => plot.redraw(false, true));
  if (stack !== undefined) stacks.set(stack, made);
  return made;
}
