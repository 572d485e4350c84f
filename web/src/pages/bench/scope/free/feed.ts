import type { TelemetrySource } from "../../../../live/TelemetrySource";
import { TraceBuffer } from "../../../../live/TraceBuffer";
import { type Cut, cut } from "../../../../live/window";
import { lowerBound, type PlotData, resampled } from "../../../../plots/series";
import { type Channels, derivedName, inputUnit, placeOf } from "./plan";

/** Samples of a channel, whoever gives them. */
export interface Samples {
  times: Float64Array;
  values: Float64Array;
}

const NONE: Cut = { x: new Float64Array(), columns: [new Float64Array()] };

/** What reads samples for plots: `bufferOf` may be the frozen ones of a paused scope. */
export interface Reading {
  sources: readonly TelemetrySource[];
  bufferOf: (source: TelemetrySource) => TraceBuffer;
  /** what to add to a device's time to get that of the plots [s] */
  shiftOf: (device: string) => number;
}

/** The columns of channels, derived ones worked out, as plots and tables need them. */
export class Feed {
  private readonly derived = new Map<string, { state: string; buffer: TraceBuffer }>();

  constructor(
    private readonly channels: Channels,
    private readonly reading: Reading,
  ) {}

  private source(device: string): TelemetrySource | undefined {
    return this.reading.sources.find(({ request }) => request.device === device);
  }

  /** Where the samples of a path lie, and what to add to their times. */
  private kept(
    path: string,
    [from, to]: readonly [number, number],
  ): { buffer: TraceBuffer; name: string; shift: number } | null {
    const name = derivedName(path);
    const place = name === null ? placeOf(path) : this.leading(name);
    const source = place && this.source(place.device);
    if (!place || !source) return null;
    const shift = this.reading.shiftOf(place.device);
    if (name === null) return { buffer: this.reading.bufferOf(source), name: place.channel, shift };
    const buffer = this.work(name, source, from - shift, to - shift);
    return buffer && { buffer, name, shift };
  }

  private leading(name: string) {
    const [letter = ""] = this.channels.formula(name)?.inputs ?? [];
    return placeOf(this.channels.derived[name]?.inputs[letter] ?? "");
  }

  /** A derived channel between two times of its leading device; the buffer of before where nothing has changed. */
  private work(name: string, leading: TelemetrySource, from: number, to: number): TraceBuffer | null {
    const formula = this.channels.formula(name);
    const inputs = this.channels.derived[name]?.inputs;
    if (!formula || !inputs) return null;
    const own = this.reading.bufferOf(leading);
    const revisions = this.reading.sources.map((source) => this.reading.bufferOf(source).revision).join();
    const state = `${from} ${to} ${revisions} ${own.channels.join()}`;
    const before = this.derived.get(name);
    if (before?.state === state) return before.buffer;
    const all = own.times();
    const begin = Math.max(0, lowerBound(all, from - formula.leadS) - 1);
    const end = Math.min(all.length, lowerBound(all, to) + 1);
    const times = all.subarray(begin, end);
    const columns = formula.inputs.map((letter) => {
      const path = inputs[letter] ?? "";
      return [letter, this.input(path, leading.request.device, times, begin, end)] as const;
    });
    const shown = Math.max(0, lowerBound(times, from) - 1);
    const values = formula.run({ times, columns: Object.fromEntries(columns), from: shown });
    const buffer = new TraceBuffer([name], Math.max(1, values.length));
    buffer.append({ sequence: 0, rows: times.length, dropped: 0, time: times, columns: [values] });
    // rows are counted as in the buffer that they come from: then its buckets are theirs, and nothing shimmers
    buffer.total = own.total - all.length + end;
    this.derived.set(name, { state, buffer });
    return buffer;
  }

  private input(path: string, leading: string, times: Float64Array, begin: number, end: number): Float64Array {
    const place = placeOf(path);
    const source = place && this.source(place.device);
    const buffer = source && this.reading.bufferOf(source);
    const column = place && buffer?.column(place.channel);
    const { factor } = inputUnit(path, this.channels);
    if (!place || !source || !buffer || !column) return new Float64Array(times.length).fill(Number.NaN);
    const raw =
      place.device === leading
        ? column.subarray(begin, end)
        : resampled(
            times,
            buffer.times(),
            column,
            this.reading.shiftOf(place.device) - this.reading.shiftOf(leading),
            2.5 / source.request.rateHz,
          );
    return factor === 1 ? raw : raw.map((value) => value * factor);
  }

  /** All samples of a path in a window, gaps as NaN. */
  samples(path: string, window: readonly [number, number]): Samples {
    const kept = this.kept(path, window);
    if (!kept) return { times: new Float64Array(), values: new Float64Array() };
    const all = kept.buffer.times();
    const [first, end] = [lowerBound(all, window[0] - kept.shift), lowerBound(all, window[1] - kept.shift)];
    const times = all.subarray(first, end);
    return {
      times: kept.shift === 0 ? times : times.map((time) => time + kept.shift),
      values: kept.buffer.column(kept.name)?.subarray(first, end) ?? new Float64Array(times.length).fill(Number.NaN),
    };
  }

  /** The value at a time, the newest where none is given. */
  value(path: string, time: number | null, window: readonly [number, number]): number {
    const kept = this.kept(path, window);
    if (!kept) return Number.NaN;
    return time === null ? kept.buffer.last(kept.name) : kept.buffer.at(kept.name, time - kept.shift);
  }

  /** What a plot over time draws: the first channel's times, the others at them. */
  overTime(paths: readonly string[], window: readonly [number, number], mostRows: number): PlotData {
    const cuts = paths.map((path) => {
      const kept = this.kept(path, window);
      if (!kept) return NONE;
      const { x, columns } = cut(
        kept.buffer,
        [{ channel: kept.name, divisor: 1 }],
        window[0] - kept.shift,
        window[1] - kept.shift,
        mostRows,
      );
      return { x: kept.shift === 0 ? x : x.map((time) => time + kept.shift), columns };
    });
    const leading = cuts.find(({ x }) => x.length > 0) ?? NONE;
    const spacing = leading.x.length > 1 ? (window[1] - window[0]) / leading.x.length : 0;
    return [
      leading.x,
      ...cuts.map(({ x, columns }) => {
        const own = columns[0] ?? new Float64Array();
        const same = x.length === leading.x.length && x[0] === leading.x[0] && x.at(-1) === leading.x.at(-1);
        return same ? own : resampled(leading.x, x, own, 0, Math.max(3 * spacing, 0.05));
      }),
    ];
  }

  /** Pairs for an XY plot: the first path's value beside each of another one's. */
  pairs(x: string, y: string, window: readonly [number, number], most: number): { x: Float64Array; y: Float64Array } {
    const [across, up] = [this.samples(x, window), this.samples(y, window)];
    const step = Math.max(1, Math.ceil(up.times.length / most));
    const times = step === 1 ? up.times : up.times.filter((_, row) => row % step === 0);
    const values = step === 1 ? up.values : up.values.filter((_, row) => row % step === 0);
    const spacing = across.times.length > 1 ? (window[1] - window[0]) / across.times.length : 0;
    return { x: resampled(times, across.times, across.values, 0, Math.max(2.5 * spacing, 1e-6)), y: values };
  }
}
