import type { RecordingCursor } from "../../lib/cursor";

/** Not more often than the picture can change [ms]. */
export const SCRUB_MS = 1000 / 30;

/**
 * Sends where a cursor is: one call at a time, no more often than every `SCRUB_MS`, and always the latest place, so
 * that a slow server is behind by one picture and not by all of them.
 */
export class Scrubber {
  private wanted: RecordingCursor | null = null;
  private busy = false;
  private ended = false;

  constructor(
    private readonly send: (to: RecordingCursor) => Promise<unknown>,
    private readonly failed: (error: unknown) => void,
    private readonly pause: (ms: number) => Promise<void> = (ms) => new Promise((done) => setTimeout(done, ms)),
  ) {}

  to(place: RecordingCursor): void {
    this.wanted = place;
    if (!this.busy && !this.ended) void this.run();
  }

  end(): void {
    this.ended = true;
    this.wanted = null;
  }

  private async run(): Promise<void> {
    this.busy = true;
    while (this.wanted !== null) {
      const place = this.wanted;
      this.wanted = null;
      try {
        await this.send(place);
      } catch (error) {
        if (!this.ended) this.failed(error);
      }
      await this.pause(SCRUB_MS);
    }
    this.busy = false;
  }
}
