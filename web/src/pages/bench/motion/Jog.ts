export type Direction = -1 | 1;

/** How long the server lets a jog go on by itself [s], and how often it hears that the button is still held [ms]. */
export const HOLD_S = 0.8;
const BEAT_MS = 200;

/**
 * Motion for as long as a button is held. The stop goes out the moment it is let go; and where the start was not yet
 * answered then, once more behind it: two requests may overtake each other, and the stop has to come last. While held
 * it says so again and again: the server stops the motor by itself when this page, or the way to it, is gone.
 */
export class Jog {
  private beat: ReturnType<typeof setInterval> | undefined;
  private held: { direction: Direction; starting: Promise<unknown>; answered: boolean } | null = null;

  constructor(
    private readonly rotate: (direction: Direction) => Promise<unknown>,
    private readonly keep: () => Promise<unknown>,
    private readonly halt: () => Promise<unknown>,
    private readonly onError: (error: unknown) => void,
    private readonly onChange: (direction: Direction | null) => void = () => undefined,
    /** an error that says that the start was not even sent: a stop would be another session's motor's */
    private readonly notSent: (error: unknown) => boolean = () => false,
  ) {}

  get direction(): Direction | null {
    return this.held?.direction ?? null;
  }

  press(direction: Direction): void {
    if (this.held) return;
    const held = { direction, starting: this.rotate(direction), answered: false };
    held.starting.then(
      () => {
        held.answered = true;
      },
      (error: unknown) => {
        held.answered = true;
        if (this.notSent(error)) this.forget(held);
        this.onError(error);
      },
    );
    this.held = held;
    // A beat that fails needs no words of its own: what ended the motion speaks for itself.
    this.beat = setInterval(() => held.answered && this.keep().catch(() => undefined), BEAT_MS);
    this.onChange(direction);
  }

  release(): void {
    const held = this.held;
    if (!held) return;
    this.held = null;
    clearInterval(this.beat);
    this.onChange(null);
    this.halt().catch(this.onError);
    if (!held.answered)
      held.starting.then(
        () => this.halt().catch(this.onError),
        () => undefined,
      );
  }

  private forget(held: object): void {
    if (this.held !== held) return;
    this.held = null;
    clearInterval(this.beat);
    this.onChange(null);
  }
}
