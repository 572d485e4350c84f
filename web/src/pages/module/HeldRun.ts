/** A stretch of one run: how fast, and for how long. */
export interface Leg {
  velocityPps: number;
  forS: number;
}

export type RunState =
  | { phase: "idle" }
  | { phase: "running"; leg: number; legs: number; velocityPps: number }
  | { phase: "done" | "stopped" }
  /** `unheardS`: for so long the server had heard nothing of this tab, if that is longer than it lets a leg go on [s] */
  | { phase: "ended"; error: unknown; unheardS?: number }
  /** the motor ran into something: a switch, a stall */
  | { phase: "stuck"; reason: string };

export interface RunPorts {
  rotate: (velocityPps: number, holdS: number) => Promise<unknown>;
  keep: (holdS: number) => Promise<unknown>;
  halt: () => Promise<unknown>;
}

/** How long the server lets a leg go on by itself [s], and how often it hears from us [ms]. */
export const HOLD_S = 1.5;
const BEAT_MS = 400;

/**
 * Turns a motor through several speeds, one after the other, for as long as this page is there: every rotation is
 * held, so that the server stops the motor by itself when nothing is heard of us any more. It ends by itself after the
 * last leg, at `abort`, and when something else has stopped the motor: then a beat is refused, and nothing is sent
 * after it, which could only disturb what has come in between.
 */
export class HeldRun {
  state: RunState = { phase: "idle" };
  private run = 0;
  private beat: ReturnType<typeof setInterval> | undefined;
  private next: ReturnType<typeof setTimeout> | undefined;
  /** when what the server heard last was sent [ms] */
  private heardAt = 0;

  constructor(
    private readonly ports: RunPorts,
    private readonly onChange: (state: RunState) => void = () => undefined,
  ) {}

  get running(): boolean {
    return this.state.phase === "running";
  }

  /** Does nothing while one runs, or without a leg. */
  start(legs: readonly Leg[]): void {
    if (this.running || legs.length === 0) return;
    this.run += 1;
    this.leg(legs, 0, this.run);
  }

  abort(): void {
    if (!this.running) return;
    this.finish({ phase: "stopped" });
    this.ports.halt().catch((error: unknown) => this.tell({ phase: "ended", error }));
  }

  /** The motor was stopped from within: what is left would only press it against the same thing again. */
  stuck(reason: string): void {
    if (!this.running) return;
    this.finish({ phase: "stuck", reason });
    this.ports.halt().catch((error: unknown) => this.tell({ phase: "ended", error }));
  }

  private leg(legs: readonly Leg[], index: number, run: number): void {
    const leg = legs[index];
    if (leg === undefined) {
      this.finish({ phase: "done" });
      this.ports.halt().catch((error: unknown) => this.tell({ phase: "ended", error }));
      return;
    }
    this.tell({ phase: "running", leg: index, legs: legs.length, velocityPps: leg.velocityPps });
    const sentAt = Date.now();
    this.ports.rotate(leg.velocityPps, HOLD_S).then(
      () => {
        this.heardAt = sentAt;
        // Aborted before the answer: the stop may have overtaken the start, and has to come last.
        if (this.run !== run || !this.running) return void this.ports.halt().catch(() => undefined);
        clearInterval(this.beat);
        this.beat = setInterval(() => this.keep(run), BEAT_MS);
        this.next = setTimeout(() => this.leg(legs, index + 1, run), leg.forS * 1000);
      },
      (error: unknown) => this.run === run && this.running && this.finish({ phase: "ended", error }),
    );
  }

  private keep(run: number): void {
    const sentAt = Date.now();
    this.ports.keep(HOLD_S).then(
      () => {
        this.heardAt = Math.max(this.heardAt, sentAt);
      },
      (error: unknown) => {
        const unheardS = (Date.now() - this.heardAt) / 1000;
        if (this.run === run && this.running)
          this.finish({ phase: "ended", error, ...(unheardS > HOLD_S && { unheardS }) });
      },
    );
  }

  private finish(state: RunState): void {
    clearInterval(this.beat);
    clearTimeout(this.next);
    this.tell(state);
  }

  private tell(state: RunState): void {
    this.state = state;
    this.onChange(state);
  }
}

/** The same legs, each longer by the ramp to its speed from the one before: `forS` is then the time at speed. */
export function withRamps(legs: readonly Leg[], accelerationPps2: number | null): Leg[] {
  if (accelerationPps2 === null || !(accelerationPps2 > 0)) return [...legs];
  return legs.map((leg, index) => ({
    ...leg,
    forS: leg.forS + Math.abs(leg.velocityPps - (legs[index - 1]?.velocityPps ?? 0)) / accelerationPps2,
  }));
}

export function durationOf(legs: readonly Leg[]): number {
  return legs.reduce((sum, leg) => sum + leg.forS, 0);
}

/**
 * Speeds from `from` to `to` in `steps` equal steps and back again, each for so long. `bothWays`: each speed to one
 * side and then to the other, so that a carriage comes back to where it was.
 */
export function sweep(from: number, to: number, steps: number, forS: number, bothWays = false): Leg[] {
  const up = Array.from({ length: steps }, (_, index) => ({
    velocityPps: steps === 1 ? to : from + ((to - from) * index) / (steps - 1),
    forS,
  }));
  const all = [...up, ...up.slice(0, -1).reverse()];
  return bothWays ? all.flatMap((leg) => [leg, { ...leg, velocityPps: -leg.velocityPps }]) : all;
}
