import { compact, rounded } from "../format";
import { FURTHER, type FurtherFigures, shifted } from "./figures";

/** Of a measured figure: more than any interval of these is narrow, and as many as somebody checks against a data sheet. */
export const DIGITS = 4;
/** Currents that differ by less are the same: a scale of the driver is no nearer. */
const SAME_CURRENT = 0.03;

/** A figure of a motor that was measured. */
export interface MeasuredFigure {
  key: keyof FurtherFigures;
  /** in SI units */
  value: number;
  /** why it may not be that of the motor alone; empty: it is */
  doubt: string;
  /** it is told with this current: a figure of motors that are rated so alone [A] */
  withA?: number;
}

/** What would become of a figure of a motor that is kept. */
export interface Change {
  key: keyof FurtherFigures;
  /** in SI units */
  after: number;
  /** the figure as it is kept, and as it would be, in words */
  text: string;
  doubt: string;
}

/** What measured figures would change of a motor: those alone that it has otherwise, or not at all. */
export function changesOf(
  motor: FurtherFigures & { rated_current_a: number },
  measured: readonly MeasuredFigure[],
): Change[] {
  return FURTHER.flatMap(({ key, label, unit, powers }) => {
    const found = measured.find((one) => one.key === key);
    if (!found || !(found.value > 0)) return [];
    if (found.withA !== undefined && Math.abs(found.withA / motor.rated_current_a - 1) > SAME_CURRENT) return [];
    const [before, after] = [motor[key], rounded(found.value, DIGITS)];
    if (before === after) return [];
    const told = (value: number) => compact(shifted(value, powers), DIGITS, unit);
    const now = before === null ? "not known" : told(before);
    return [{ key, after, text: `${label}: ${now}, becomes ${told(after)}`, doubt: found.doubt }];
  });
}
