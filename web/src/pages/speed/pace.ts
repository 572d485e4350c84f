/** The latest this many frames count. */
const KEPT = 300;

/** Keeps count of animation frames: how fast they come and what script they cost. */
export class Pace {
  frames = 0;
  private readonly times: number[] = [];
  private readonly scripts: number[] = [];
  private rowsGiven = 0;
  private startMs: number | null = null;

  /** How many samples a device of `rateHz` has taken since the last call. */
  rowsDue(nowMs: number, rateHz: number): number {
    this.startMs ??= nowMs;
    const all = Math.floor(((nowMs - this.startMs) * rateHz) / 1000);
    const due = Math.max(0, all - this.rowsGiven);
    this.rowsGiven += due;
    return due;
  }

  frame(nowMs: number, scriptMs: number): void {
    this.frames += 1;
    this.times.push(nowMs);
    this.scripts.push(scriptMs);
    if (this.times.length > KEPT) {
      this.times.shift();
      this.scripts.shift();
    }
  }

  /**
   * Frames per second and mean script time over the frames kept, and how many there ever were by which moment: from
   * two such pairs a rate over any span follows. Null before there are two frames.
   */
  figures(): { fps: number; scriptMs: number; frames: number; atMs: number } | null {
    const count = this.times.length;
    const spanMs = (this.times[count - 1] ?? 0) - (this.times[0] ?? 0);
    if (count < 2 || spanMs <= 0) return null;
    const scriptMs = this.scripts.reduce((sum, value) => sum + value, 0) / count;
    return { fps: ((count - 1) * 1000) / spanMs, scriptMs, frames: this.frames, atMs: this.times[count - 1] ?? 0 };
  }
}
