import { describe, expect, it } from "vitest";
import type { Rows } from "../../lib/rows/settings";
import { TraceBuffer } from "../../live/TraceBuffer";
import { AngleMap } from "./angleMap";
import { BinStats, binOf, joined } from "./bins";
import { fitHarmonics, fitTurn, widestHole } from "./harmonics";
import { Histogram } from "./histogram";
import { ACCELERATION, encoderSettings, INDEX_USES, indexUse, LIMIT } from "./settings";
import { spreadingSpeed, turnLegs } from "./turns";
import { encoderName } from "./useEncoder";

function randoms(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state * 48_271) % 2_147_483_647;
    return state / 2_147_483_647;
  };
}

describe("bins", () => {
  it("wrap both ways", () => {
    expect([0, 255, 256, -1, -256, 511.9].map((value) => binOf(value, 256, 8))).toEqual([0, 7, 0, 7, 0, 7]);
    expect(binOf(-1e-14, 256, 8)).toBe(7); // 1 - 1e-17 is 1 in a double
  });

  it("know mean and spread as a list of values does, also when joined", () => {
    const random = randoms(7);
    const [one, two] = [new BinStats(4), new BinStats(4)];
    const plain: number[][] = [[], []];
    for (let index = 0; index < 400; index++) {
      const bin = Math.floor(random() * 4);
      const value = 1000 + 50 * random();
      (index % 3 === 0 ? one : two).add(bin, value);
      plain[Math.floor(bin / 2)]?.push(value);
    }
    const both = joined([one, two], 2);
    for (const [bin, values] of plain.entries()) {
      const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
      const variance = values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / (values.length - 1);
      expect(both.count[bin]).toBe(values.length);
      expect(both.mean[bin]).toBeCloseTo(mean, 9);
      expect(both.spread(bin)).toBeCloseTo(Math.sqrt(variance), 9);
    }
    expect(both.total).toBe(400);
    expect(new BinStats(3).covered).toBe(0);
    expect(new BinStats(3).spread(0)).toBeNaN();
  });
});

describe("harmonics", () => {
  it("come out of bins that were seen unevenly", () => {
    const bins = new BinStats(200);
    const random = randoms(3);
    for (let index = 0; index < 20_000; index++) {
      const angle = 2 * Math.PI * random() ** 2; // half of all samples in the first quarter
      const bin = binOf(angle, 2 * Math.PI, 200);
      bins.add(bin, 5 + 40 * Math.cos(angle - 1) + 7 * Math.cos(3 * angle - 4) + random() - 0.5);
    }
    const fit = fitHarmonics(bins, [1, 2, 3]);
    expect(fit?.offset).toBeCloseTo(5, 1);
    const [once, twice, thrice] = fit?.terms ?? [];
    expect(once?.amplitude).toBeCloseTo(40, 0);
    expect(once?.phase).toBeCloseTo(1, 2);
    expect(twice?.amplitude).toBeLessThan(0.2);
    expect(thrice?.amplitude).toBeCloseTo(7, 0);
    expect(thrice?.phase).toBeCloseTo(4, 1);
    expect(fit?.rest).toBeLessThan(0.5);
  });

  it("make good what a bin's mean takes from a short wave", () => {
    const bins = new BinStats(16);
    for (let index = 0; index < 16_000; index++) {
      const angle = (2 * Math.PI * index) / 16_000;
      bins.add(binOf(index, 16_000, 16), Math.cos(4 * angle));
    }
    expect(fitHarmonics(bins, [4])?.terms[0]?.amplitude).toBeCloseTo(1, 3);
  });

  it("are not told from half a turn", () => {
    const bins = new BinStats(100);
    for (let bin = 0; bin < 50; bin++) bins.add(bin, 1);
    expect(widestHole(bins)).toBe(0.5);
    expect(fitHarmonics(bins, [1])).toBeNull();
    expect(widestHole(new BinStats(4))).toBe(1);
    const round = new BinStats(10); // the hole goes over the end: bins 9, 0 and 1
    for (let bin = 2; bin < 9; bin++) round.add(bin, 1);
    expect(widestHole(round)).toBeCloseTo(0.3);
  });
});

describe("the map of a turn", () => {
  /** An eccentric magnet, a detent ripple and friction, seen by an encoder of 1024 steps. */
  function deviationAt(position: number, forward: boolean): number {
    const angle = (2 * Math.PI * position) / 51_200;
    const rotor = position + 60 * Math.cos(angle - 0.5) + 8 * Math.sin(200 * angle) + (forward ? -12 : 12);
    return Math.round((rotor * 1024) / 51_200) * 50 - position;
  }

  function turned(): AngleMap {
    const map = new AngleMap(200, 256);
    for (let step = 0; step < 6 * 3001; step++) {
      const position = Math.round((step * 51_200) / 3001);
      map.add(position, deviationAt(position, true), true);
      map.add(-position, deviationAt(-position, false), false);
    }
    return map;
  }

  it("finds eccentricity and detent below the step of the encoder", () => {
    const map = turned();
    const fit = fitTurn(map.turn("both", 200), map.period("both"), 200);
    const once = fit.named.find((term) => term.perTurn === 1);
    const detent = fit.named.find((term) => term.perTurn === 200);
    expect(once?.amplitude).toBeCloseTo(60, 0);
    expect(once?.phase).toBeCloseTo(0.5, 1);
    expect(detent?.amplitude).toBeGreaterThan(7);
    expect(detent?.amplitude).toBeLessThan(9);
    expect(fit.named.find((term) => term.perTurn === 50)?.amplitude).toBeLessThan(1);
  });

  it("tells the directions apart", () => {
    const map = turned();
    expect(map.reversal()).toBeCloseTo(24, 0);
    // half a turn more one way is not taken for friction: eccentricity would look like it
    for (let position = 0; position < 25_600; position += 7) map.add(position, deviationAt(position, true), true);
    expect(map.reversal()).toBeCloseTo(24, 0);
    expect(map.histogram("backward").count).toBe(18_006);
    expect(map.histogram("both").count).toBe(map.histogram("forward").count + 18_006);
    expect(new AngleMap(200, 256).reversal()).toBeNaN();
  });

  it("reads each row once, leaves out rest and gaps, and counts turns", () => {
    const channels = { position: "p", velocity: "v", deviation: "d" };
    const buffer = new TraceBuffer(["p", "v", "d"], 100);
    const map = new AngleMap(200, 256);
    const rows = (time: number[], position: number[], velocity: number[], deviation: number[]) =>
      buffer.append({
        sequence: 0,
        rows: time.length,
        dropped: 0,
        time: Float64Array.from(time),
        columns: [position, velocity, deviation].map((values) => Float64Array.from(values)),
      });
    rows([1, 2, 3], [0, 12_800, 12_800], [9, 9, 0], [4, 6, 99]);
    map.read(buffer, channels);
    map.read(buffer, channels);
    expect([map.histogram("both").count, map.histogram("both").mean, map.turns]).toEqual([2, 5, 0.25]);
    rows([4, 5], [25_600, Number.NaN], [9, 9], [8, 8]);
    map.read(buffer, channels);
    expect([map.histogram("both").count, map.turns]).toEqual([3, 0.5]);
    rows([0.5], [0], [-9], [1]); // power cycled: another time begins
    map.read(buffer, channels);
    expect(map.histogram("backward").count).toBe(1);
    map.clear();
    expect([map.histogram("both").count, map.turns, map.turn("both").covered]).toEqual([0, 0, 0]);
  });
});

describe("a slow turn", () => {
  it("goes there and back, a little more than whole turns", () => {
    const legs = turnLegs({ rpm: 6, turns: 2, back: true }, 51_200, 200);
    expect(legs).toHaveLength(2);
    for (const leg of legs) {
      expect(Math.abs(leg.velocityPps)).toBeCloseTo(5120, -3);
      expect(Math.abs(leg.velocityPps) * leg.forS).toBeGreaterThan(2 * 51_200);
    }
    expect(legs[1]?.velocityPps).toBe(-(legs[0]?.velocityPps ?? 0));
  });

  it("keeps its samples from falling on the same places of every period", () => {
    for (const wanted of [1024, 5120, 4266.67, 9000]) {
      const velocity = spreadingSpeed(wanted, 1024, 200);
      expect(Math.abs(velocity / wanted - 1)).toBeLessThan(0.08);
      const seen = new Set<number>();
      for (let sample = 0; sample < 64 * 50; sample++) seen.add(binOf((sample * velocity) / 200, 1024, 64));
      expect(seen.size).toBe(64);
    }
    // few samples a period: nothing can be gained, and the speed would be another
    expect(spreadingSpeed(102_400, 1024, 200)).toBe(102_400);
  });
});

describe("the histogram", () => {
  it("knows mean, rms and the peak with its sign", () => {
    const histogram = new Histogram();
    for (const value of [3, -5, 2, 0]) histogram.add(value);
    expect([histogram.mean, histogram.peak, histogram.count]).toEqual([0, -5, 4]);
    expect(histogram.rms).toBeCloseTo(Math.sqrt(38 / 4));
    expect(histogram.spread).toBeCloseTo(Math.sqrt(38 / 4));
    expect(new Histogram().bars()).toEqual([]);
  });

  it("loses no value however far apart they are, and keeps to its number of bars", () => {
    const random = randoms(11);
    const [one, two] = [new Histogram(), new Histogram()];
    for (let index = 0; index < 5000; index++) {
      one.add(200 * random() - 100);
      two.add(1e6 * random());
    }
    one.take(two);
    const bars = one.bars(40);
    expect(bars.length).toBeLessThanOrEqual(40);
    expect(bars.reduce((sum, bar) => sum + bar.count, 0)).toBe(10_000);
    expect(bars[0]?.from).toBeLessThanOrEqual(-99);
    for (const [index, bar] of bars.entries()) if (index > 0) expect(bar.from).toBe(bars[index - 1]?.to);
  });

  it("has a class for every whole number while they are few", () => {
    const histogram = new Histogram();
    for (const value of [-2, -2, 0, 1]) histogram.add(value);
    expect(histogram.bars()).toEqual([
      { from: -2, to: -1, count: 2 },
      { from: -1, to: 0, count: 0 },
      { from: 0, to: 1, count: 1 },
      { from: 1, to: 2, count: 1 },
    ]);
  });
});

describe("a chip's settings", () => {
  it("are in its registers, an acceleration in pps²", () => {
    const values: Record<string, number> = { AMAX: 1000 };
    const staged: Record<string, number> = {};
    const rows: Rows = {
      spot: (register) => (register in values ? ({} as ReturnType<Rows["spot"]>) : null),
      held: (register) => values[register] ?? null,
      planned: (register) => staged[register] ?? values[register] ?? null,
      isStaged: (register) => register in staged,
      put: (register, _, value) => {
        staged[register] = value;
      },
    };
    const settings = encoderSettings(rows, 16e6);
    expect(settings.held(ACCELERATION)).toBeCloseTo(116_415, 0);
    expect(settings.held(LIMIT.internal)).toBeNull();
    settings.stage(LIMIT.internal, 5);
    expect(staged).toEqual({});
    values.ENC_DEVIATION = 0;
    settings.stage(LIMIT.internal, 5);
    settings.stage(ACCELERATION, 232_830);
    expect(staged).toEqual({ ENC_DEVIATION: 5, AMAX: 2000 });
    expect(settings.planned(LIMIT.internal)).toBe(5);
  });

  it("tell the uses of the index channel by their bits, and no mixture", () => {
    for (const use of INDEX_USES)
      expect(indexUse((field) => use.fields[field as keyof typeof use.fields])?.name).toBe(use.name);
    expect(indexUse(() => 1)).toBeNull();
    expect(indexUse(() => null)).toBeNull();
  });

  it("call the only encoder by no other name", () => {
    expect(encoderName("internal", ["internal"])).toBe("Encoder");
    expect(encoderName("external", ["internal", "external"])).toBe("External encoder");
  });
});
