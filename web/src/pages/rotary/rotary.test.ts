import { describe, expect, it } from "vitest";
import { arc, arrow, between, wayText } from "./dial";
import { fromNumber, grouped, mod, parseRatio, ratio, ratioText, ratioWire, rounded, toNumber, wholeOf } from "./exact";
import { type Answer, compareCount, extendedOf, liveActual, liveEncoder } from "./extended";
import { pair } from "./gears";
import { longTime, Pace, pieceCount, viewOf } from "./pieces";
import { broken, liveColumns, lookColumns, tooFast, unwound } from "./traces";
import { angleAt, degreesOf, follow, geared, placeOf, snapped, targetAt } from "./turn";

const TURN = { length: ratio(51_200n), zero: 0n };
const GEARED = { length: geared(51_200n, 3n, 7n), zero: 0n };
const FAR = (1n << 62n) + 12_345n;

describe("numbers as people type them", () => {
  it.each([
    ["1 000", ratio(1000n)],
    ["1_000_000", ratio(1_000_000n)],
    ["-3.25", ratio(-13n, 4n)],
    ["−3,25", ratio(-13n, 4n)],
    ["1e12", ratio(10n ** 12n)],
    ["1.5e-1", ratio(3n, 20n)],
    ["2^40", ratio(1n << 40n)],
    ["-2^63", ratio(-(1n << 63n))],
    ["0x10", ratio(16n)],
    ["1.5k", ratio(1500n)],
    ["3M", ratio(3_000_000n)],
    ["358400/3", ratio(358_400n, 3n)],
    [" 716800 / 6 ", ratio(358_400n, 3n)],
    ["9007199254740993", ratio(9_007_199_254_740_993n)],
  ])("%s", (text, value) => {
    expect(parseRatio(text)).toEqual(value);
  });

  it.each(["", "-", ".", "12a", "1/0", "1/2/3", "1e99", "2^999", "--1", "0x", "NaN", "1/"])("is none: %s", (text) => {
    expect(parseRatio(text)).toBeNull();
  });

  it("keeps every digit beyond 2^53", () => {
    expect(grouped(-9_223_372_036_854_775_808n)).toBe("−9\u202f223\u202f372\u202f036\u202f854\u202f775\u202f808");
    expect(grouped(5120n)).toBe("5120");
    expect(wholeOf("9007199254740993")).toBe(9_007_199_254_740_993n);
    expect(wholeOf("1.5")).toBeNull();
    expect(wholeOf(null)).toBeNull();
  });

  it("writes ratios for people and for the server", () => {
    expect(ratioText(GEARED.length)).toBe("358\u202f400/3");
    expect(ratioText(GEARED.length, true)).toBe("119\u202f466 2/3");
    expect(ratioText(ratio(1n, 3n), true)).toBe("1/3");
    expect(ratioWire(GEARED.length)).toBe("358400/3");
    expect(ratioWire(ratio(51_200n))).toBe("51200");
  });

  it("takes a browser's number for what it is", () => {
    expect(fromNumber(0.1)).toEqual(ratio(3_602_879_701_896_397n, 1n << 55n));
    expect(toNumber(fromNumber(-273.15))).toBe(-273.15);
    expect(toNumber(ratio(10n ** 30n, 10n ** 30n - 1n))).toBe(1);
    expect(toNumber(ratio(-1n, 4n))).toBe(-0.25);
    expect(() => fromNumber(Number.NaN)).toThrow(RangeError);
  });

  it("rounds halves up and divides downwards, as the server does", () => {
    expect([ratio(5n, 2n), ratio(-5n, 2n), ratio(7n, 3n)].map(rounded)).toEqual([3n, -2n, 2n]);
    expect(mod(-1n, 7n)).toBe(6n);
  });
});

describe("a turn", () => {
  it("is split into whole turns and an angle, below zero too", () => {
    expect(placeOf(-1n, TURN)).toMatchObject({ turns: -1n, place: ratio(51_199n) });
    expect(placeOf(128_000n, TURN)).toEqual({ turns: 2n, place: ratio(25_600n), angleDeg: 180 });
    expect(placeOf(100n, { length: ratio(400n), zero: 100n }).angleDeg).toBe(0);
  });

  it("is exact behind a gear after more turns than a browser can count", () => {
    const turns = 3n * 10n ** 12n;
    const there = (turns * GEARED.length.n) / GEARED.length.d;
    expect(placeOf(there, GEARED)).toEqual({ turns, place: ratio(0n), angleDeg: 0 });
    // two of three turns end between microsteps
    expect(placeOf(119_467n, GEARED)).toMatchObject({ turns: 1n, place: ratio(1n, 3n) });
    expect(placeOf(119_466n, GEARED).turns).toBe(0n);
  });

  it("has three ways to an angle", () => {
    expect(targetAt(12_800n, TURN, 350, "shortest")).toBe(49_778n - 51_200n);
    expect(targetAt(12_800n, TURN, 350, "positive")).toBe(49_778n);
    expect(targetAt(12_800n, TURN, 350, "negative")).toBe(49_778n - 51_200n);
    expect(targetAt(0n, TURN, 180, "shortest")).toBe(25_600n);
    expect(targetAt(0n, TURN, -90, "shortest")).toBe(-12_800n);
    expect(targetAt(0n, TURN, 720, "positive")).toBe(0n);
    expect(targetAt(FAR, TURN, 0, "positive") - FAR).toBeLessThan(51_200n);
  });

  it("goes nowhere where it is there already", () => {
    for (const way of ["shortest", "positive", "negative"] as const)
      expect(targetAt(51_200n * 10n ** 13n, TURN, 0, way)).toBe(51_200n * 10n ** 13n);
  });

  it("rounds in every turn anew, so nothing adds up", () => {
    expect([0n, 1n, 2n, 3n].map((turn) => targetAt(turn * 119_467n, GEARED, 0, "shortest"))).toEqual([
      0n,
      119_467n,
      238_933n,
      358_400n,
    ]);
  });

  it("says a way in degrees", () => expect(degreesOf(-76_800n, TURN)).toBe(-540));

  it("follows a counter through its wraps", () => {
    expect(follow(FAR, 2 ** 31 - 5, -(2 ** 31) + 5, 32)).toBe(FAR + 10n);
    expect(follow(FAR, -(2 ** 31) + 5, 2 ** 31 - 5, 32)).toBe(FAR - 10n);
    expect(follow(7n, 8_388_600, -8_388_600, 24)).toBe(23n);
  });

  it("knows where a pointer is", () => {
    expect([angleAt(0, -1), angleAt(1, 0), angleAt(0, 1), angleAt(-1, 0)]).toEqual([0, 90, 180, 270]);
    expect(snapped(359.7, 1)).toBe(0);
    expect(snapped(47, 5)).toBe(45);
  });
});

describe("the pieces of a long move", () => {
  const PIECE = 1n << 30n;

  it("are whole but the first", () => {
    const way = 3n * PIECE + PIECE / 2n;
    const view = viewOf(0n, way, PIECE / 4n, PIECE);
    expect(view).toMatchObject({ total: 4, done: 0, before: 0, after: 0 });
    expect(view.segments.map(({ state }) => state)).toEqual(["underway", "left", "left", "left"]);
    expect(view.segments[0]?.share).toBeCloseTo(0.5);
    expect(viewOf(0n, way, PIECE, PIECE).segments[1]).toEqual({ index: 1, state: "underway", share: 0.5 });
  });

  it("count the same both ways, and end", () => {
    expect(viewOf(5n, 5n - 2n * PIECE, 5n - PIECE, PIECE)).toMatchObject({ total: 2, done: 1, progress: 0.5 });
    const there = viewOf(0n, 2n * PIECE, 2n * PIECE, PIECE);
    expect(there).toMatchObject({ total: 2, done: 2, progress: 1 });
    expect(there.segments.every(({ state }) => state === "done")).toBe(true);
    expect(viewOf(9n, 9n, 9n, PIECE)).toMatchObject({ total: 0, segments: [], progress: 1 });
  });

  it("beyond what can be drawn are counted either side", () => {
    const target = (1n << 62n) - 1n;
    const view = viewOf(-target, target, 0n, PIECE);
    expect(view.total).toBe(2 ** 33);
    expect(view.segments).toHaveLength(24);
    expect(view.before + view.segments.length + view.after).toBe(view.total);
    expect(view.segments[8]?.state).toBe("underway");
    expect(view.progress).toBeCloseTo(0.5);
    expect(viewOf(0n, 100n * PIECE, 100n * PIECE - 1n, PIECE)).toMatchObject({ before: 76, after: 0 });
  });

  it("past the target or before the start stay inside", () => {
    expect(viewOf(0n, PIECE, -10n, PIECE)).toMatchObject({ done: 0, progress: 0 });
    expect(pieceCount(-PIECE - 1n, PIECE)).toBe(2);
  });

  it("take a time that people can read", () => {
    expect([5, 65, 3725, 200_000, 1e9, null, Number.POSITIVE_INFINITY].map(longTime)).toEqual([
      "5\u202fs",
      "1:05\u202fmin",
      "1\u202fh 2\u202fmin",
      "2\u202fd 7\u202fh",
      "32\u202fyears",
      "–",
      "–",
    ]);
  });

  it("go at the pace of the last seconds", () => {
    const pace = new Pace(2);
    expect(pace.timeTo(10n, 0n)).toBeNull();
    for (let second = 0; second < 10; second++) pace.add(second, FAR + BigInt(second < 5 ? 0 : (second - 5) * 100));
    expect(pace.pps).toBe(100);
    expect(pace.timeTo(FAR + 1400n, FAR + 400n)).toBe(10);
    expect(pace.timeTo(FAR - 1n, FAR + 400n)).toBeNull();
    pace.add(3, 0n);
    expect(pace.pps).toBe(100);
    pace.clear();
    expect(pace.pps).toBeNull();
    expect(pace.timeTo(5n, 5n)).toBe(0);
  });
});

describe("history", () => {
  it("breaks an angle where it wraps, and nothing else", () => {
    const [time, commanded, encoder] = broken([0, 1, 2], [350, 10, 20], [300, 310, null]);
    expect([...(time ?? [])]).toEqual([0, 0.5, 1, 2]);
    expect([...(commanded ?? [])]).toEqual([350, Number.NaN, 10, 20]);
    expect([...(encoder ?? [])]).toEqual([300, 305, 310, Number.NaN]);
  });

  it("says when an angle over time means nothing", () => {
    expect(tooFast([0, 0.1, 0.2, 0.4])).toBe(false);
    expect(tooFast([0, 0.7, 1.4, 2.1])).toBe(true);
    expect(tooFast([])).toBe(false);
  });

  it("unwinds a counter from its newest sample", () => {
    const counts = [2 ** 23 - 20, 2 ** 23 - 10, Number.NaN, -(2 ** 23), -(2 ** 23) + 10];
    expect([...unwound(counts, 24)]).toEqual([-30, -20, Number.NaN, -10, 0]);
    expect([...unwound([0, -100, -200], 32)]).toEqual([200, 100, 0]);
  });

  it("draws samples as turns, exactly from far away", () => {
    const drawn = liveColumns({
      time: Float64Array.of(10, 11, 12),
      counts: Float64Array.of(-51_200, Number.NaN, 0),
      encoderCounts: Float64Array.of(5, 5, 25_605),
      bits: 32,
      actual: FAR,
      encoder: FAR + 1n,
      turn: TURN,
      what: "turns",
      divisor: 60,
    });
    expect(drawn.since).toBe(FAR / 51_200n);
    expect([...drawn.x].map((x) => x * 60)).toEqual([-2, -1, 0]);
    expect((drawn.commanded[2] as number) - (drawn.commanded[0] as number)).toBe(1);
    expect(drawn.commanded[1]).toBeNaN();
    expect(((drawn.encoder[2] as number) - (drawn.commanded[2] as number)) * 51_200).toBeCloseTo(1, 6);
    expect((drawn.encoder[2] as number) - (drawn.encoder[1] as number)).toBe(0.5);
  });

  it("draws the server's looks, the encoder beside what was told", () => {
    const looks = {
      time_s: [0, 1, 2],
      position_text: ["51190", "51210", "102400"],
      angle_deg: [359.93, 0.07, 0],
      encoder_angle_deg: [0.5, null, 358],
    };
    const turns = lookColumns(looks, TURN, "turns", 1);
    expect(turns.since).toBe(0n);
    expect(turns.commanded[2]).toBe(2);
    expect(turns.encoder[0]).toBeCloseTo(1 + 0.5 / 360);
    expect(turns.encoder[1]).toBeNaN();
    expect(turns.encoder[2]).toBeCloseTo(2 - 2 / 360);
    const angles = lookColumns(looks, TURN, "angle", 1);
    expect(angles.fast).toBe(true);
    expect(angles.commanded.some(Number.isNaN)).toBe(true);
  });
});

describe("an answer of the server", () => {
  const ANSWER = {
    watching: true,
    trusted: true,
    reason: "",
    actual_text: "9007199254740993",
    target_text: "9007199254741993",
    encoder_position_text: "9007199254740990",
    progress: 0.5,
    counter: 1,
    counter_bits: 24,
    pieces: null,
    rotary: { microsteps_per_turn: "358400/3", zero_text: "-7" },
  } as unknown as Answer;

  it("loses no digit", () => {
    expect(extendedOf(ANSWER)).toMatchObject({
      actual: 9_007_199_254_740_993n,
      turn: { length: ratio(358_400n, 3n), zero: -7n },
      start: 9_007_199_254_739_993n,
      pieceLength: 1n << 22n,
    });
  });

  it("goes on with the newest counts", () => {
    const seen = extendedOf(ANSWER);
    expect(liveActual(seen, -1)).toBe(9_007_199_254_740_991n);
    expect(liveActual(seen, Number.NaN)).toBe(seen.actual);
    expect(liveActual(null, 5)).toBeNull();
    // the encoder's counter is 12 beyond the chip's, across the end of both
    expect(liveEncoder(seen, 2 ** 23 - 2, -(2 ** 23) + 10)).toBe((liveActual(seen, 2 ** 23 - 2) as bigint) + 12n);
    expect(liveEncoder({ ...seen, encoder: null }, 1, 13)).toBeNull();
    expect(liveEncoder(seen, 1, Number.NaN)).toBe(9_007_199_254_740_990n);
  });

  it("has no start once it is there", () => {
    expect(extendedOf({ ...ANSWER, progress: 1 } as Answer).start).toBeNull();
    expect(extendedOf({ ...ANSWER, actual_text: null } as Answer)).toMatchObject({ actual: null, start: null });
  });
});

describe("the compare register on a plot of the counter", () => {
  const armed = { compare: { position_text: "5000000100", armed: true }, actual_text: "5000000000", counter: -7 };

  it("is as far from what the counter shows as from the axis", () => {
    expect(compareCount(armed as unknown as Answer)).toBe(93);
  });

  it("is not drawn while it waits, or where nothing is known", () => {
    const waits = { ...armed, compare: { ...armed.compare, armed: false } };
    for (const answer of [waits, { ...armed, compare: null }, { ...armed, actual_text: null }])
      expect(compareCount(answer as unknown as Answer)).toBeNull();
  });
});

describe("the dial's drawing", () => {
  it("shows a way either way, and what is beyond a turn in words", () => {
    expect(arc(0, 90, 100)).toMatch(/^M0.00 -100.00A100 100 0 0 1 100.00 -?0.00$/);
    expect(arc(90, -270, 100)).toMatch(/ 0 1 0 /);
    expect(arc(0, 360, 10).match(/A/g)).toHaveLength(2);
    expect(arc(5, 0, 10)).toBe("");
    expect(arrow(0, 0.5, 10)).toBe("");
    expect(arrow(0, -90, 100)).toMatch(/^M-100/);
    expect([90, -12.345, 810, -360, 720.5].map(wayText)).toEqual([
      "+90.0°",
      "−12.3°",
      "+2 turns 90.0°",
      "−1 turn 0.00°",
      "+2 turns 0.50°",
    ]);
    expect([between(350, 10), between(10, 350), between(0, 180)]).toEqual([20, -20, -180]);
  });

  it("meshes gears of any teeth", () => {
    const { motor, driven } = pair(3, 7, 150);
    expect(driven.x - motor.x).toBeCloseTo(motor.radius + driven.radius);
    expect(motor.radius / driven.radius).toBeCloseTo(3 / 7);
    expect([motor.teeth, driven.teeth]).toEqual([9, 21]);
    expect(motor.path.match(/L/g)).toHaveLength(9 * 4 - 1);
    expect(pair(1, 100_000, 150).motor.radius).toBeGreaterThan(5);
    expect(pair(1, 100_000, 150).driven.path).toContain("A");
  });
});
