import type { components } from "../schema";

/** Who may change the bench, as the server tells it. */
export type Lease = components["schemas"]["LeaseInfo"];
export type Asker = Lease["asking"][number];
export type OnVanish = Lease["on_vanish"];

/** How the server is asked; tests bring their own. Each answers with the lease as it is then, or throws. */
export interface LeasePorts {
  look: () => Promise<Lease>;
  take: () => Promise<Lease>;
  change: (change: { on_vanish: OnVanish; vanish_after_s: number }) => Promise<Lease>;
  giveBack: () => Promise<Lease>;
  ask: () => Promise<Lease>;
  handOver: (to: string) => Promise<Lease>;
  /** calls every few seconds until the answer is called */
  beat: (look: () => void) => () => void;
  /** whether our token may never have the bench: then nobody is asked for it, and the server says why it refuses */
  onlyLooks?: () => boolean;
}

/**
 * Why the user is asked: after something that waits for the bench, or after something held down, which is not done
 * later by itself, when nobody holds it any more.
 */
export type Cause = "held" | "change";

/** What a user is asked who has tried to change the bench without having it. */
export interface Question {
  cause: Cause;
  /** it was another session's and has become ours: that may be minutes later, so it is asked whether to go on */
  handed: boolean;
}

export interface LeaseView {
  /** null until the server has told */
  lease: Lease | null;
  /** when it told, by performance.now() */
  heardMs: number;
  question: Question | null;
  /** we ask the holder for it, again and again */
  asking: boolean;
  /** why the last step with the lease failed */
  problem: unknown;
  /** how the bench came or went without our doing, until that is shown */
  news: "handed" | "lost" | null;
}

/** Whether the first who wants the bench has it: nobody has it, or its last page was closed. */
export function isFree(lease: Lease): boolean {
  return lease.state === "free" || (lease.left && !lease.mine);
}

/** An ask stays with the server for a few seconds. */
const ASK_EVERY_MS = 2000;

/**
 * The page's side of the lease: what is known of it, what keeps it alive, and everybody who waits for it. Whatever
 * would change the bench asks `permit` first: without the lease one question is opened for all that wait, and its
 * answer lets all of them go on, or none.
 */
export class LeaseClient {
  private view: LeaseView = { lease: null, heardMs: 0, question: null, asking: false, problem: null, news: null };
  private readonly listeners = new Set<() => void>();
  private waiting: ((go: boolean) => void)[] = [];
  private endBeat: (() => void) | null = null;
  private askedMs = Number.NEGATIVE_INFINITY;
  /** answers come in any order: one that was asked before what we know now says nothing new */
  private asked = 0;
  private heard = 0;
  private ours = false;
  private taking: Promise<boolean> | null = null;
  /** how often all motors were told to stop */
  private drops = 0;

  constructor(private readonly ports: LeasePorts) {}

  get snapshot(): LeaseView {
    return this.view;
  }

  get mine(): boolean {
    return this.view.lease?.mine === true;
  }

  readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  /** Look, and say once more that we ask. Never throws: without an answer the last one stays. */
  async refresh(nowMs = performance.now()): Promise<void> {
    try {
      await this.hear(this.ports.look);
      if (!this.view.asking || nowMs - this.askedMs < ASK_EVERY_MS) return;
      this.askedMs = nowMs;
      await this.hear(this.ports.ask);
    } catch {
      // the page says elsewhere that the server does not answer
    }
  }

  take(): Promise<boolean> {
    return this.own(this.ports.take);
  }

  giveBack(): Promise<boolean> {
    return this.own(this.ports.giveBack);
  }

  handOver(to: string): Promise<boolean> {
    return this.own(() => this.ports.handOver(to));
  }

  onVanish(on_vanish: OnVanish, vanish_after_s: number): Promise<boolean> {
    return this.step(() => this.ports.change({ on_vanish, vanish_after_s }));
  }

  async ask(): Promise<boolean> {
    this.askedMs = performance.now();
    this.set({ asking: true });
    const done = await this.step(this.ports.ask);
    if (!done) this.set({ asking: false });
    return done;
  }

  stopAsking(): void {
    if (!this.view.asking) return;
    this.set({ asking: false });
    void this.step(this.ports.giveBack); // of what we have not got: it ends our asking
  }

  /**
   * Whether the bench may be changed: at once where it is ours or nobody's, else when the question is answered. Where
   * the server tells nothing of leases it is the server that decides.
   */
  async permit(): Promise<boolean> {
    const { drops } = this;
    if (this.view.lease === null) await this.refresh();
    const ours = this.view.lease === null || this.mine || (await this.takeFree());
    if (drops !== this.drops) return false; // a stop is behind it, and would be overtaken
    if (ours) return true;
    this.open("change");
    return new Promise((resolve) => this.waiting.push(resolve));
  }

  /** The same for what is held down: true only if it is ours now. Else the question is opened, and nothing waits. */
  async permitHeld(): Promise<boolean> {
    if (this.view.lease === null || this.mine || this.ports.onlyLooks?.() || (await this.takeFree())) return true;
    this.open("held");
    return false;
  }

  /** Take the bench that nobody has: the first change does it, without a word. Whoever was quicker is asked then. */
  private async takeFree(): Promise<boolean> {
    const { lease, question } = this.view;
    if (lease === null || question !== null || !isFree(lease)) return false;
    this.taking ??= this.take().finally(() => {
      this.taking = null;
    });
    return this.taking;
  }

  /** The server has refused a change: what we believed of the lease was wrong. */
  async refused(): Promise<void> {
    const { lease } = this.view;
    if (lease?.mine) this.set({ lease: { ...lease, state: "free", holder: null, mine: false } });
    await this.refresh();
  }

  /** What is answered to the question. To go on takes the bench, where it is not ours yet. */
  async answer(go: boolean): Promise<void> {
    if (go && !this.mine && !(await this.take())) return; // another session was quicker: the question says so
    const waiting = this.waiting;
    this.waiting = [];
    if (!go) this.stopAsking();
    this.set({ question: null, problem: null });
    for (const resolve of waiting) resolve(go);
  }

  /** All motors are to stop: what still waits to be sent is not wanted any more. */
  drop(): void {
    this.drops += 1;
    if (this.view.question) void this.answer(false);
  }

  dismiss(): void {
    this.set({ problem: null, news: null });
  }

  private open(cause: Cause): void {
    const open = this.view.question;
    // one question for all: it tells of what waits, whatever has asked before
    if (open && cause !== "change") return;
    this.set({ question: { cause, handed: open?.handed ?? false }, problem: null });
  }

  /** A step that gives or takes the bench by our own will. */
  private own(call: () => Promise<Lease>): Promise<boolean> {
    this.ours = true;
    return this.step(call).finally(() => {
      this.ours = false;
    });
  }

  private async step(call: () => Promise<Lease>): Promise<boolean> {
    try {
      await this.hear(call);
      this.set({ problem: null });
      return true;
    } catch (problem) {
      this.set({ problem });
      await this.refresh();
      return false;
    }
  }

  private async hear(call: () => Promise<Lease>): Promise<void> {
    this.asked += 1;
    const number = this.asked;
    const lease = await call();
    if (number < this.heard) return;
    this.heard = number;
    const { lease: before, question, asking } = this.view;
    // another tab of this browser may have taken it for both: only what was asked for was handed over
    const came = question !== null || asking ? "handed" : null;
    const news = this.ours || before === null || before.mine === lease.mine ? null : lease.mine ? came : "lost";
    this.set({
      lease,
      heardMs: performance.now(),
      asking: asking && lease.state === "taken" && !lease.mine,
      ...(news === "handed" && question ? { question: { ...question, handed: true } } : news ? { news } : {}),
    });
    this.keepAlive(lease.mine);
  }

  private keepAlive(mine: boolean): void {
    // a look is a sign of life as any request is, and none that the server refuses when the lease has ended meanwhile
    if (mine && this.endBeat === null) this.endBeat = this.ports.beat(() => void this.refresh());
    else if (!mine) {
      this.endBeat?.();
      this.endBeat = null;
    }
  }

  private set(change: Partial<LeaseView>): void {
    this.view = { ...this.view, ...change };
    for (const listener of this.listeners) listener();
  }
}
