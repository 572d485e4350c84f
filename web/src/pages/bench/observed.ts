/** One look at an axis: where it counts itself [full steps], and its switches; NaN where something is not known. */
export interface Look {
  timeS: number;
  position: number;
  /** full steps a second */
  speed: number;
  left: number;
  right: number;
  home: number;
}

/** A counter that goes further between two looks than its speed explains, and by this much more, was set anew. */
const SLACK_FULLSTEPS = 6;

/**
 * Where the switches of a stage seem to be, from what was seen of them: nobody tells it of a real one. Places are in
 * full steps of the counter; null until an edge has passed. When the counter is set anew, they move with it.
 */
export class ObservedStage {
  left: number | null = null;
  right: number | null = null;
  homeFrom: number | null = null;
  homeTo: number | null = null;
  /** the stretch that was travelled; NaN before the first look */
  lowest = Number.NaN;
  highest = Number.NaN;
  revision = 0;
  private before: Look | null = null;

  /** The device time of the newest look [s]; minus infinity before the first. */
  get lookedAtS(): number {
    return this.before?.timeS ?? Number.NEGATIVE_INFINITY;
  }

  /** Whether the counter was set anew between two looks: it has gone further than its speed explains. */
  static jumped(before: Look, now: Look): boolean {
    const speed = Math.max(Math.abs(before.speed) || 0, Math.abs(now.speed) || 0);
    return Math.abs(now.position - before.position) > 1.5 * speed * (now.timeS - before.timeS) + SLACK_FULLSTEPS;
  }

  look(now: Look): void {
    if (Number.isNaN(now.position)) return;
    const { before } = this;
    if (before !== null && now.timeS <= before.timeS) {
      if (now.timeS < before.timeS) this.before = now; // the device has begun another life
      return;
    }
    this.before = now;
    if (before === null) {
      this.travelled(now.position);
      this.atRest(now);
      return;
    }
    const way = now.position - before.position;
    if (ObservedStage.jumped(before, now)) {
      this.shift(way);
      return;
    }
    this.travelled(now.position);
    // The edge lies between both looks; in the middle it is wrong by half of that at most.
    const edge = (now.position + before.position) / 2;
    if (before.left !== now.left && !Number.isNaN(before.left + now.left)) this.set("left", edge);
    if (before.right !== now.right && !Number.isNaN(before.right + now.right)) this.set("right", edge);
    if (before.home !== now.home && !Number.isNaN(before.home + now.home)) {
      // rising on the way to the right, or falling on the way back: its left edge
      const entering = now.home > 0.5;
      if (way !== 0) this.set(entering === way > 0 ? "homeFrom" : "homeTo", edge);
    }
    this.atRest(now);
  }

  /** A switch that is active where the carriage is cannot be seen further in. */
  private atRest({ position, left, right }: Look): void {
    if (left > 0.5 && this.left !== null && position > this.left) this.set("left", position);
    if (right > 0.5 && this.right !== null && position < this.right) this.set("right", position);
  }

  private set(key: "left" | "right" | "homeFrom" | "homeTo", value: number): void {
    if (this[key] === value) return;
    this[key] = value;
    if (this.homeFrom !== null && this.homeTo !== null && this.homeFrom > this.homeTo)
      [this.homeFrom, this.homeTo] = [this.homeTo, this.homeFrom];
    this.revision += 1;
  }

  private travelled(position: number): void {
    if (position >= this.lowest && position <= this.highest) return;
    this.lowest = Math.min(position, Number.isNaN(this.lowest) ? position : this.lowest);
    this.highest = Math.max(position, Number.isNaN(this.highest) ? position : this.highest);
    this.revision += 1;
  }

  /** The counter was set: what was seen lies elsewhere in the new counting. */
  shift(by: number): void {
    const moved = (value: number | null) => (value === null ? null : value + by);
    this.left = moved(this.left);
    this.right = moved(this.right);
    this.homeFrom = moved(this.homeFrom);
    this.homeTo = moved(this.homeTo);
    this.lowest += by;
    this.highest += by;
    this.revision += 1;
  }

  /** What to draw [full steps]: the stretch travelled and the switches, widened to whole turns so that it stands still. */
  range(fullStepsPerTurn: number): [from: number, to: number] {
    if (Number.isNaN(this.lowest)) return [-fullStepsPerTurn, fullStepsPerTurn];
    const all = [this.lowest, this.highest, this.left, this.right, this.homeFrom, this.homeTo].filter(
      (value): value is number => value !== null,
    );
    const turn = 2 * fullStepsPerTurn;
    return [Math.floor(Math.min(...all) / turn - 0.25) * turn, Math.ceil(Math.max(...all) / turn + 0.25) * turn];
  }
}
