const FRAMES_HZ = 60;
/** A frame that took so many of the display's periods was late. */
const LATE = 1.2;
/** How slowly a longer period is believed: a frame without a plot may have been late for something else. */
const BELIEVED = 0.02;
/** So often a plot is drawn at the least, however slow the machine is [Hz]. */
const LEAST_HZ = 4;
/** What a late frame leaves of the plots a frame, and what each other one makes of them. */
const FEWER = 0.85;
const MORE = 1.005;

/**
 * Shares frames among plots: as many are drawn in each as leave the page its 60 a second, or as many as its
 * display has, the longest undrawn first.
 *
 * What a plot costs is not measured but seen: a browser paints after the script has ended. So a late frame makes it
 * fewer plots a frame, and each one in time a few more again. Frames without any tell the display's period.
 */
export class Turns {
  private perFrame = Number.POSITIVE_INFINITY;
  private credit = 0;
  private asked = new Set<string>();
  private before = new Set<string>();
  private chosen = new Set<string>();
  private nowMs = Number.NEGATIVE_INFINITY;
  private periodMs = 1000 / FRAMES_HZ;
  private readonly drawnMs = new Map<string, number>();

  /** Whether plot `id` is drawn in the frame of `nowMs`. */
  take(id: string, nowMs: number): boolean {
    if (nowMs !== this.nowMs) this.begin(nowMs);
    this.asked.add(id);
    if (this.before.has(id) && !this.chosen.has(id)) return false;
    this.drawnMs.set(id, nowMs);
    return true;
  }

  /** Choose among those that had something new in the frame before. */
  private begin(nowMs: number): void {
    const tookMs = nowMs - this.nowMs;
    this.nowMs = nowMs;
    [this.before, this.asked] = [this.asked, new Set()];
    for (const id of this.drawnMs.keys()) if (!this.before.has(id)) this.drawnMs.delete(id);
    const all = this.before.size;
    if (all === 0) return;
    if (this.chosen.size === 0 && Number.isFinite(tookMs)) {
      // at most twice as long: a page that was hidden has seen no frame
      const longer = Math.min(Math.max(tookMs - this.periodMs, 0), this.periodMs);
      this.periodMs = Math.max(1000 / FRAMES_HZ, Math.min(tookMs, this.periodMs) + BELIEVED * longer);
    }
    const wanted = tookMs > LATE * this.periodMs ? Math.min(this.perFrame, all) * FEWER : this.perFrame * MORE;
    this.perFrame = Math.min(Math.max(wanted, (all * LEAST_HZ) / FRAMES_HZ), all);
    this.credit = Math.min(this.credit, 1) + this.perFrame;
    const longest = [...this.before].sort(
      (one, other) => (this.drawnMs.get(one) ?? 0) - (this.drawnMs.get(other) ?? 0),
    );
    this.chosen = new Set(longest.slice(0, Math.floor(this.credit)));
    this.credit -= this.chosen.size;
  }
}

/** Those of this page. */
export const TURNS = new Turns();
