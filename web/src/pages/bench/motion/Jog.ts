export type Direction = -1 | 1;

/**
 * Motion for as long as a button is held. The stop goes out the moment it is let go; and where the start was not yet
 * answered then, once more behind it: two requests may overtake each other, and the stop has to come last.
 */
export class Jog {
  private held: { direction: Direction; starting: Promise<unknown>; answered: boolean } | null = null;

  constructor(
    private readonly rotate: (direction: Direction) => Promise<unknown>,
    private readonly halt: () => Promise<unknown>,
    private readonly onError: (error: unknown) => void,
    private readonly onChange: (direction: Direction | null) => void = () => undefined,
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
        this.onError(error);
      },
    );
    this.held = held;
    this.onChange(direction);
  }

  release(): void {
    const held = this.held;
    if (!held) return;
    this.held = null;
    this.onChange(null);
    this.halt().catch(this.onError);
    if (!held.answered)
      held.starting.then(
        () => this.halt().catch(this.onError),
        () => undefined,
      );
  }
}
