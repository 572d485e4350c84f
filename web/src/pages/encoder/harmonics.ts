import type { BinStats } from "./bins";

/** amplitude * cos(order * angle - phase) */
export interface Harmonic {
  /** how often in one period */
  order: number;
  amplitude: number;
  /** radians, 0..2 pi */
  phase: number;
}

export interface HarmonicFit {
  offset: number;
  terms: Harmonic[];
  /** what remains: root of the mean square over the bins */
  rest: number;
}

/**
 * Mean and harmonics of what the bins hold, by least squares over the bins that hold something, all alike: a bin
 * seen more often is no larger part of the turn. null while too much of the period is missing to tell the orders
 * apart. A bin's mean flattens a wave that is not much longer than it; that is put right.
 */
export function fitHarmonics(bins: BinStats, orders: readonly number[]): HarmonicFit | null {
  const highest = Math.max(...orders);
  if (widestHole(bins) >= 1 / (2 * highest)) return null;
  const unknowns = 1 + 2 * orders.length;
  const rows: { basis: number[]; value: number }[] = [];
  for (let bin = 0; bin < bins.size; bin++) {
    if ((bins.count[bin] as number) === 0) continue;
    const angle = (2 * Math.PI * (bin + 0.5)) / bins.size;
    const basis = [1, ...orders.flatMap((order) => [Math.cos(order * angle), Math.sin(order * angle)])];
    rows.push({ basis, value: bins.mean[bin] as number });
  }
  if (rows.length < 2 * unknowns) return null;
  const matrix = Array.from({ length: unknowns }, (_, row) =>
    Array.from({ length: unknowns + 1 }, (_, column) =>
      rows.reduce(
        (sum, { basis, value }) =>
          sum + (basis[row] as number) * (column < unknowns ? (basis[column] as number) : value),
        0,
      ),
    ),
  );
  const solution = solved(matrix);
  if (solution === null) return null;
  const squares = rows.reduce((sum, { basis, value }) => {
    const fitted = basis.reduce((part, factor, index) => part + factor * (solution[index] as number), 0);
    return sum + (value - fitted) ** 2;
  }, 0);
  return {
    offset: solution[0] as number,
    rest: Math.sqrt(squares / rows.length),
    terms: orders.map((order, index) => {
      const [cosine, sine] = [solution[1 + 2 * index] as number, solution[2 + 2 * index] as number];
      const half = (Math.PI * order) / bins.size;
      const phase = Math.atan2(sine, cosine);
      return {
        order,
        amplitude: (Math.hypot(cosine, sine) * half) / Math.sin(half),
        phase: phase < 0 ? phase + 2 * Math.PI : phase,
      };
    }),
  };
}

/** The longest run of empty bins, round the end, as a share of the period; 1 for no bin at all. */
export function widestHole(bins: BinStats): number {
  let widest = 0;
  let run = 0;
  for (let index = 0; index < 2 * bins.size; index++) {
    run = (bins.count[index % bins.size] as number) === 0 ? run + 1 : 0;
    widest = Math.max(widest, run);
  }
  return Math.min(1, widest / bins.size);
}

/** Gauss's elimination with row exchange of an augmented matrix; null where it has no single solution. */
function solved(matrix: number[][]): number[] | null {
  const size = matrix.length;
  const scale = Math.max(...matrix.map((row, index) => Math.abs(row[index] as number)));
  for (let column = 0; column < size; column++) {
    let best = column;
    for (let row = column + 1; row < size; row++)
      if (Math.abs(matrix[row]?.[column] as number) > Math.abs(matrix[best]?.[column] as number)) best = row;
    const pivot = matrix[best] as number[];
    if (Math.abs(pivot[column] as number) < 1e-9 * scale) return null;
    matrix[best] = matrix[column] as number[];
    matrix[column] = pivot;
    for (let row = 0; row < size; row++) {
      if (row === column) continue;
      const target = matrix[row] as number[];
      const factor = (target[column] as number) / (pivot[column] as number);
      for (let index = column; index <= size; index++)
        target[index] = (target[index] as number) - factor * (pivot[index] as number);
    }
  }
  return matrix.map((row, index) => (row[size] as number) / (row[index] as number));
}

/** What is told of a motor's deviation: how often a turn, and what that usually comes from. */
export interface NamedHarmonic extends Harmonic {
  perTurn: number;
  name: string;
}

/** Orders looked for in a turn and in an electrical period (four full steps). */
const TURN_ORDERS = [1, 2, 3, 4] as const;
const PERIOD_ORDERS = [1, 2, 4] as const;
const FULLSTEPS_PER_PERIOD = 4;

const TURN_NAMES: Record<(typeof TURN_ORDERS)[number], string> = {
  1: "eccentricity",
  2: "ellipse, tilt",
  3: "",
  4: "",
};
const PERIOD_NAMES: Record<(typeof PERIOD_ORDERS)[number], string> = {
  1: "coil offset",
  2: "coil difference",
  4: "detent, once a full step",
};

export interface TurnFit {
  /** null while too little of the turn was seen */
  turn: HarmonicFit | null;
  period: HarmonicFit | null;
  named: NamedHarmonic[];
}

export function fitTurn(turn: BinStats, period: BinStats, fullStepsPerTurn: number): TurnFit {
  const slow = fitHarmonics(turn, TURN_ORDERS);
  const fast = fitHarmonics(period, PERIOD_ORDERS);
  const periods = fullStepsPerTurn / FULLSTEPS_PER_PERIOD;
  return {
    turn: slow,
    period: fast,
    named: [
      ...(slow?.terms.map((term) => ({
        ...term,
        perTurn: term.order,
        name: TURN_NAMES[term.order as (typeof TURN_ORDERS)[number]],
      })) ?? []),
      ...(fast?.terms.map((term) => ({
        ...term,
        perTurn: term.order * periods,
        name: PERIOD_NAMES[term.order as (typeof PERIOD_ORDERS)[number]],
      })) ?? []),
    ],
  };
}
