import { currentAt, ENTRIES, entryAt, POSITIONS } from "./wave";

interface Wave {
  values: readonly number[];
  mirror: number;
}

/**
 * What the chip showed of its wave: the current of phase A at each position where it was seen. Phase B is the same
 * wave 256 positions ahead, so each sample shows two places. What cannot be read back is seen when the motor turns.
 */
export class Seen {
  readonly current = new Float32Array(POSITIONS).fill(Number.NaN);
  /** counts changes: draw again when it differs from the one drawn */
  revision = 0;
  places = 0;
  wrong = 0;

  clear(): void {
    this.current.fill(Number.NaN);
    this.places = 0;
    this.wrong = 0;
    this.revision += 1;
  }

  /** `apart`: how many positions the motor may have moved between the readings of one sample. */
  add(position: number, a: number, b: number, wave: Wave, apart: number): void {
    if (Number.isNaN(position + a + b)) return;
    this.put(position, a, wave, apart);
    this.put((position + ENTRIES) % POSITIONS, b, wave, apart);
  }

  private put(position: number, current: number, wave: Wave, apart: number): void {
    if (this.current[position] === current) return;
    if (Number.isNaN(this.current[position])) this.places += 1;
    this.current[position] = current;
    this.revision += 1;
    let [low, high] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
    for (let near = position - apart; near <= position + apart; near++) {
      const expected = currentAt(wave.values, wave.mirror, near);
      low = Math.min(low, expected);
      high = Math.max(high, expected);
    }
    if (current < low || current > high) this.wrong += 1;
  }

  /** Dots over a quarter (folded onto it) or the period: place and value. */
  dots(quarter: boolean, mirror: number): [place: number, value: number][] {
    const found: [number, number][] = [];
    this.current.forEach((current, position) => {
      if (Number.isNaN(current)) return;
      const { index, negative } = entryAt(position);
      if (quarter) found.push([index, negative ? mirror - current : current]);
      else found.push([position, current]);
    });
    return found;
  }
}
