import type { Samples } from "./feed";

const SAMPLES_MAX = 8192;
const SAMPLES_LEAST = 16;

export interface LiveSpectrum {
  frequencyHz: Float64Array;
  /** of a sine that would make this line, in the channel's unit */
  amplitude: Float64Array;
}

/**
 * What the newest samples without a gap swing at: without their slope, Hann's window, at even times. Null for too few of
 * them.
 */
export function spectrumOf({ times, values }: Samples): LiveSpectrum | null {
  let end = values.length;
  while (end > 0 && Number.isNaN(values[end - 1])) end -= 1;
  let first = end;
  while (first > 0 && end - first < SAMPLES_MAX && !Number.isNaN(values[first - 1])) first -= 1;
  const size = 2 ** Math.floor(Math.log2(end - first));
  if (!(size >= SAMPLES_LEAST)) return null;
  first = end - size;
  const t0 = times[first] as number;
  const step = ((times[end - 1] as number) - t0) / (size - 1);
  if (!(step > 0)) return null;
  const even = new Float64Array(size);
  let row = first;
  for (let index = 0; index < size; index++) {
    const at = t0 + index * step;
    while (row < end - 2 && (times[row + 1] as number) < at) row += 1;
    const [a = 0, b = 0, from = 0, to = 0] = [values[row], values[row + 1], times[row], times[row + 1]];
    even[index] = to > from ? a + ((b - a) * (at - from)) / (to - from) : a;
  }
  level(even);
  for (let index = 0; index < size; index++)
    even[index] = (even[index] as number) * (0.5 - 0.5 * Math.cos((2 * Math.PI * index) / size));
  const imaginary = new Float64Array(size);
  transform(even, imaginary);
  const lines = size / 2;
  // two sides, and the window's mean of one half
  const amplitude = Float64Array.from(
    { length: lines },
    (_, line) => (4 / size) * Math.hypot(even[line] as number, imaginary[line] as number),
  );
  return { frequencyHz: Float64Array.from({ length: lines }, (_, line) => line / (size * step)), amplitude };
}

/** Takes the straight line of least squares off. */
function level(values: Float64Array): void {
  const size = values.length;
  const middle = (size - 1) / 2;
  const mean = values.reduce((sum, value) => sum + value, 0) / size;
  let slope = 0;
  let weight = 0;
  values.forEach((value, index) => {
    slope += (index - middle) * (value - mean);
    weight += (index - middle) ** 2;
  });
  slope /= weight;
  values.forEach((value, index) => {
    values[index] = value - mean - slope * (index - middle);
  });
}

/** The discrete Fourier transform in place, of a power of two many (Cooley and Tukey 1965). */
function transform(real: Float64Array, imaginary: Float64Array): void {
  const size = real.length;
  for (let index = 1, reversed = 0; index < size; index++) {
    let bit = size >> 1;
    for (; reversed & bit; bit >>= 1) reversed ^= bit;
    reversed ^= bit;
    if (index < reversed) {
      [real[index], real[reversed]] = [real[reversed] as number, real[index] as number];
      [imaginary[index], imaginary[reversed]] = [imaginary[reversed] as number, imaginary[index] as number];
    }
  }
  for (let length = 2; length <= size; length *= 2) {
    const half = length / 2;
    for (let turn = 0; turn < half; turn++) {
      const angle = (-2 * Math.PI * turn) / length;
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      for (let one = turn; one < size; one += length) {
        const other = one + half;
        const re = (real[other] as number) * cos - (imaginary[other] as number) * sin;
        const im = (real[other] as number) * sin + (imaginary[other] as number) * cos;
        real[other] = (real[one] as number) - re;
        imaginary[other] = (imaginary[one] as number) - im;
        real[one] = (real[one] as number) + re;
        imaginary[one] = (imaginary[one] as number) + im;
      }
    }
  }
}
