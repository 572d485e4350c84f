import { describe, expect, it } from "vitest";
import { TelemetrySource } from "../../../../live/TelemetrySource";
import type { TraceBuffer } from "../../../../live/TraceBuffer";
import type { Derived, FreePlot } from "../settings";
import { Feed } from "./feed";
import { added, Channels, type Known, pathOf, placeOf, refusal, requestsFor, without } from "./plan";
import { spectrumOf } from "./spectrum";
import { statisticsOf } from "./statistics";

function device(id: string, units: Record<string, string>, rate_max_hz = 1000): Known {
  const channels = Object.entries(units).map(([name, unit]) => ({ name, quantity: name, axis: 0, unit }));
  return { id, name: id.toUpperCase(), channels, rate_max_hz } as Known;
}
const DEVICES = [
  device("xy", { "position.0": "microsteps", "velocity.0": "pps", "load_angle.0": "deg", "load_value.0": "" }),
  device("a/b:c", { "position.0": "microsteps" }, 100),
];
const X = pathOf("xy", "position.0");
const V = pathOf("xy", "velocity.0");
const ANGLE = pathOf("xy", "load_angle.0");
const OTHER = pathOf("a/b:c", "position.0");
const SLIP: Derived = { formula: "a - b", inputs: { a: X, b: OTHER } };
const channels = new Channels(DEVICES, { slip: SLIP, wrong: { formula: "a +", inputs: { a: X } } });
const plot = (y: string[], kind: FreePlot["kind"] = "time"): FreePlot => ({ id: "1", kind, y });

describe("a path", () => {
  it("names a channel of any device", () => {
    expect(placeOf(OTHER)).toEqual({ device: "a/b:c", channel: "position.0" });
    expect(placeOf("=:slip")).toBeNull();
    expect(placeOf("%E0%A4%A:position.0")).toBeNull();
  });
});

describe("a plot", () => {
  it("takes a second unit, and says why not a third", () => {
    expect(refusal(plot([X]), V, channels)).toBeNull();
    expect(refusal(plot([X, V]), OTHER, channels)).toBeNull();
    expect(refusal(plot([X, V]), ANGLE, channels)).toBe(
      "° has no axis here: its two y axes are µsteps and pps. Put it into another plot",
    );
    expect(refusal(plot([X]), X, channels)).toContain("in this plot already");
    expect(refusal(plot([X]), pathOf("gone", "position.0"), channels)).toContain("is not there now");
  });

  it("of spectra has one unit, of pairs any across", () => {
    expect(refusal(plot([X], "spectrum"), V, channels)).toContain("its one y axis is µsteps");
    expect(refusal(plot([X, V], "xy"), ANGLE, channels)).toContain("its one y axis is pps");
    expect(refusal(plot([X], "xy"), ANGLE, channels)).toBeNull();
  });

  it("begins with a channel and ends with the last", () => {
    const one = added([], null, X, channels);
    if ("refused" in one) throw new Error(one.refused);
    expect(one.free).toEqual([{ id: "1", kind: "time", y: [X] }]);
    expect(added(one.free, "1", ANGLE, channels)).toMatchObject({ free: [{ y: [X, ANGLE] }] });
    expect(without(one.free, "1", X)).toEqual([]);
  });

  it("asks each device for what it needs, inputs of formulas as well, no faster than it can", () => {
    expect(requestsFor([plot(["=:slip", V])], channels, 500)).toEqual([
      { device: "xy", channels: ["position.0", "velocity.0"], rateHz: 500, keepS: 60 },
      { device: "a/b:c", channels: ["position.0"], rateHz: 100, keepS: 300 },
    ]);
  });

  it("knows the unit of a derived channel, and none of one that is wrong", () => {
    expect(channels.unit("=:slip")).toBe("µsteps");
    expect(channels.unit("=:wrong")).toBeNull();
    expect(channels.unit("=:constructor")).toBeNull();
  });
});

function source(id: string, rateHz: number, names: string[], times: number[], ...columns: number[][]): TelemetrySource {
  const made = new TelemetrySource({ device: id, channels: names, rateHz, keepS: 60 });
  made.buffer.append({
    sequence: 0,
    rows: times.length,
    dropped: 0,
    time: Float64Array.from(times),
    columns: columns.map((column) => Float64Array.from(column)),
  });
  return made;
}

describe("the feed", () => {
  const sources = [
    source("xy", 1, ["position.0", "velocity.0"], [1, 2, 3, 4], [10, 20, 30, 40], [1, 1, 1, 1]),
    source("a/b:c", 1, ["position.0"], [101, 102, 103, 104], [1, 2, 3, 4]),
  ];
  const reading = {
    sources,
    bufferOf: (each: TelemetrySource): TraceBuffer => each.buffer,
    shiftOf: (id: string) => (id === "xy" ? 0 : -100),
  };

  it("works derived channels out at the leading one's times, of devices with other clocks", () => {
    const feed = new Feed(channels, reading);
    const [x, slip, other] = feed.overTime(["=:slip", OTHER], [0, 10], 1000);
    expect([...(x as Float64Array)]).toEqual([1, 2, 3, 4]);
    expect([...(slip as Float64Array)]).toEqual([9, 18, 27, 36]);
    expect([...(other as Float64Array)]).toEqual([1, 2, 3, 4]);
    expect(feed.value("=:slip", 3, [0, 10])).toBe(27);
    expect(feed.value(OTHER, 2, [0, 10])).toBe(2);
  });

  it("is the same filter however little of it is on show", () => {
    const lowpassed = new Channels(DEVICES, { f: { formula: "mean(a, 3)", inputs: { a: X } } });
    const feed = new Feed(lowpassed, reading);
    expect(feed.value("=:f", 4, [0, 10])).toBe(feed.value("=:f", 4, [3.5, 10]));
  });

  it("pairs channels at one time", () => {
    const { x, y } = new Feed(channels, reading).pairs(X, OTHER, [0, 10], 100);
    expect([...x]).toEqual([10, 20, 30, 40]);
    expect([...y]).toEqual([1, 2, 3, 4]);
  });
});

describe("a live spectrum", () => {
  it("finds a sine by its frequency and amplitude, behind the last gap and whatever its slope", () => {
    const times = Float64Array.from({ length: 1200 }, (_, row) => row / 1000);
    const values = times.map((time, row) =>
      row === 100 ? Number.NaN : 5 * time + 3 * Math.sin(2 * Math.PI * 62.5 * time),
    );
    const found = spectrumOf({ times, values });
    if (!found) throw new Error("there are samples enough");
    const top = found.amplitude.indexOf(Math.max(...found.amplitude));
    expect(found.frequencyHz[top]).toBeCloseTo(62.5, 0);
    expect(found.amplitude[top]).toBeCloseTo(3, 1);
  });

  it("is none of a few samples", () => {
    expect(spectrumOf({ times: Float64Array.of(1, 2), values: Float64Array.of(1, 2) })).toBeNull();
  });
});

describe("statistics", () => {
  it("are of the samples from the first cursor to the second, both included, without those that are missing", () => {
    const times = Float64Array.of(0, 1, 2, 3, 4, 5);
    const values = Float64Array.of(100, 2, Number.NaN, 4, 6, 100);
    const found = statisticsOf({ times, values }, 1, 4);
    expect(found).toMatchObject({ samples: 3, missing: 1, minimum: 2, maximum: 6, mean: 4, peakToPeak: 4 });
    expect(found.rms).toBeCloseTo(Math.sqrt(56 / 3), 12);
    expect(found.sd).toBeCloseTo(Math.sqrt(8 / 3), 12);
    expect(statisticsOf({ times, values }, 2, 2)).toMatchObject({ samples: 0, missing: 1, minimum: Number.NaN });
  });
});
