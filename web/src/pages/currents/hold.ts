/** IHOLDDELAY and TPOWERDOWN count in so many clocks (TMC5160 data sheet, 6.2). */
const DELAY_CLOCKS = 2 ** 18;
/** Clocks without a step after which the motor counts as standing: DRV_STATUS.stst. */
const STANDSTILL_CLOCKS = 2 ** 20;

export interface HoldSettings {
  irun: number;
  ihold: number;
  iholddelay: number;
  /** null: the chip has no TPOWERDOWN */
  tpowerdown: number | null;
  clockHz: number;
}

export interface HoldTimes {
  /** from the last step until the current begins to fall [s] */
  waitS: number;
  /** one step of the current scale [s]; 0: at once */
  stepS: number;
  /** how long it falls [s] */
  fallS: number;
}

/** How long a motor keeps its run current after its last step, and how long the current then falls. */
export function holdTimes({ irun, ihold, iholddelay, tpowerdown, clockHz }: HoldSettings): HoldTimes {
  const wait = tpowerdown === null ? STANDSTILL_CLOCKS : tpowerdown * DELAY_CLOCKS;
  const step = (iholddelay * DELAY_CLOCKS) / clockHz;
  return { waitS: wait / clockHz, stepS: step, fallS: step * Math.abs(irun - ihold) };
}

/**
 * The current scale over time around a stop at time 0, as a line of steps: the motor runs, takes its last step, waits,
 * and goes down (or up) to its hold current by one a step. `perScale` is what a scale is in A.
 */
export function holdLine(settings: HoldSettings, perScale: (scale: number) => number): { x: number[]; y: number[] } {
  const { irun, ihold } = settings;
  const { waitS, stepS, fallS } = holdTimes(settings);
  const lead = Math.max(0.05, (waitS + fallS) * 0.18);
  const x = [-lead, 0, waitS];
  const y = [perScale(irun), perScale(irun), perScale(irun)];
  const way = Math.sign(ihold - irun);
  for (let scale = irun; scale !== ihold; ) {
    scale += way;
    const at = waitS + Math.abs(scale - irun) * stepS;
    x.push(at, at);
    y.push(perScale(scale - way), perScale(scale));
  }
  x.push(waitS + fallS + lead);
  y.push(perScale(ihold));
  return { x, y };
}
