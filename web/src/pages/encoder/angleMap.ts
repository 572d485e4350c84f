import type { TraceBuffer } from "../../live/TraceBuffer";
import { BinStats, binOf, joined } from "./bins";
import { Histogram } from "./histogram";

export type Direction = "both" | "forward" | "backward";

/** Bins of a full step in the picture of a turn: enough to see the ripple of the detent torque. */
const BINS_PER_FULLSTEP = 8;
/** Bins of an electrical period, four full steps. */
export const PERIOD_BINS = 64;
const FULLSTEPS_PER_PERIOD = 4;

interface Side {
  turn: BinStats;
  period: BinStats;
  histogram: Histogram;
}

/**
 * The deviation of one encoder against the angle of the shaft, gathered over many turns, each direction for itself:
 * friction pulls the rotor back either way, and the mean of both would hide it. The angle is that of the position
 * counter, from its zero. Samples at rest are left out: they would only weigh one bin, and fill the histogram.
 */
export class AngleMap {
  readonly forward: Side;
  readonly backward: Side;
  /** turns of the shaft that were looked at */
  turns = 0;
  revision = 0;
  private readTo = Number.NEGATIVE_INFINITY;

  constructor(
    readonly fullStepsPerTurn: number,
    readonly microstepsPerFullStep: number,
  ) {
    const side = (): Side => ({
      turn: new BinStats(fullStepsPerTurn * BINS_PER_FULLSTEP),
      period: new BinStats(PERIOD_BINS),
      histogram: new Histogram(),
    });
    this.forward = side();
    this.backward = side();
  }

  get microstepsPerTurn(): number {
    return this.fullStepsPerTurn * this.microstepsPerFullStep;
  }

  add(position: number, deviation: number, forward: boolean): void {
    const side = forward ? this.forward : this.backward;
    side.turn.add(binOf(position, this.microstepsPerTurn, side.turn.size), deviation);
    side.period.add(binOf(position, FULLSTEPS_PER_PERIOD * this.microstepsPerFullStep, PERIOD_BINS), deviation);
    side.histogram.add(deviation);
  }

  /** Take in the rows that have come since the last call. Rows with anything missing are left out. */
  read(buffer: TraceBuffer, channels: { position: string; velocity: string; deviation: string }): void {
    const times = buffer.times();
    const position = buffer.column(channels.position);
    const velocity = buffer.column(channels.velocity);
    const deviation = buffer.column(channels.deviation);
    const newest = buffer.lastTime;
    if (position === null || velocity === null || deviation === null || Number.isNaN(newest)) return;
    if (newest < this.readTo) this.readTo = Number.NEGATIVE_INFINITY; // the device has begun another life
    if (newest === this.readTo) return;
    let row = times.length;
    while (row > 0 && (times[row - 1] as number) > this.readTo) row--;
    let before = position[row - 1] ?? Number.NaN;
    for (; row < times.length; row++) {
      const [at, speed, off] = [position[row] as number, velocity[row] as number, deviation[row] as number];
      if (speed !== 0 && !Number.isNaN(at + speed + off)) {
        this.add(at, off, speed > 0);
        // a counter that is set anew is no motion
        const way = Math.abs(at - before);
        if (way < this.microstepsPerTurn) this.turns += way / this.microstepsPerTurn;
      }
      before = at;
    }
    this.readTo = newest;
    this.revision += 1;
  }

  private sides(direction: Direction): Side[] {
    if (direction === "both") return [this.forward, this.backward];
    return [direction === "forward" ? this.forward : this.backward];
  }

  /** The turn in `bins` bins, by default as fine as it was gathered. */
  turn(direction: Direction, bins = this.forward.turn.size): BinStats {
    return joined(
      this.sides(direction).map((side) => side.turn),
      bins,
    );
  }

  /** One electrical period: all of them in a turn laid over each other. */
  period(direction: Direction): BinStats {
    return joined(
      this.sides(direction).map((side) => side.period),
      PERIOD_BINS,
    );
  }

  histogram(direction: Direction): Histogram {
    const result = new Histogram();
    for (const side of this.sides(direction)) result.take(side.histogram);
    return result;
  }

  /**
   * Mean of backward minus forward [microsteps], over the full steps that were seen both ways: twice what friction
   * holds the rotor back. NaN before a tenth of the turn was.
   */
  reversal(): number {
    const [forward, backward] = [
      this.turn("forward", this.fullStepsPerTurn),
      this.turn("backward", this.fullStepsPerTurn),
    ];
    let sum = 0;
    let both = 0;
    for (let bin = 0; bin < forward.size; bin++) {
      if ((forward.count[bin] as number) === 0 || (backward.count[bin] as number) === 0) continue;
      sum += (backward.mean[bin] as number) - (forward.mean[bin] as number);
      both += 1;
    }
    return both * 10 < forward.size ? Number.NaN : sum / both;
  }

  clear(): void {
    for (const side of [this.forward, this.backward]) {
      side.turn.clear();
      side.period.clear();
      side.histogram.clear();
    }
    this.turns = 0;
    this.revision += 1;
  }
}
