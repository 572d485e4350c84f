import { describe, expect, it } from "vitest";
import { changedIn, differences, distancesOf, endedBy, type Move, ranked } from "./byHand/moves";
import { type ChopperFound, type ChopperTried, namedOf, rippleOf } from "./chopper/tried";
import { bodeOf, type Loop, nicholsOf, tensTicks } from "./closedLoop/curves";
import { coilOf, coilWith, FIRST_COIL } from "./coil";
import { presetOf, type Searchable } from "./customSearch/form";
import { type CustomFound, evidenceRows } from "./customSearch/found";
import { furtherOf, shapesOf } from "./fastestMove/form";
import { at, movesOf, timesOf } from "./fastestMove/moves";
import { choicesOf, nearestOf, proofOf } from "./fastestMove/trials";
import { withMotor as identified } from "./identification/form";
import { documentOf, firstForms, goalsOf } from "./kinds";
import { withMotor as cooler } from "./leastCurrent/form";
import { triedOf } from "./leastCurrent/tried";
import { addedOf, errorOf, harmonicsOf, type Microsteps } from "./microstepCalibration/curves";
import { knownOf, type NamedMotor } from "./motor/motor";
import { campbellOf, changeOf, colourOf, type ResonanceFound, saidOf, walked } from "./resonanceMap/dots";
import { aloneText, rateText, rocOf, type StallSpeed, thresholdText } from "./stallguard/rates";
import { torqueFrom } from "./stealthchop/form";
import { joltsOf, reachOf, type StealthTried } from "./stealthchop/tried";
import { type Finding, figureOf, namedOnce, remedyOf, type Study, sentencesOf, twinTold } from "./study";
import { curveOf, rowsOf, type TorquePoint } from "./torqueCurve/points";
import { FIRST_TWIN, isTried, named, takenFrom, twinOf } from "./twin/form";

type Trial = Study["trials"][number];

function trial(number: number, state: Trial["state"], speed: number, time: number | null): Trial {
  return {
    number,
    state,
    setting: { speed, acceleration: speed * 4 },
    registers: [],
    figures: {
      time_s: time,
      spread_s: null,
      deviation_fullsteps: number,
      lost_fullsteps: 0,
      runs: 1,
      by_distance_s: [],
    },
    expected_s: 0.5,
    why: "",
    at_s: 0,
  };
}

const PLATE: NamedMotor = {
  name: "17HS",
  own: false,
  source: "a list",
  rated_current_a: 2,
  full_steps_per_rev: 200,
  resistance_ohm: 1.4,
  inductance_h: null,
  holding_torque_nm: 0.59,
  rotor_inertia_kgm2: null,
};

const TRIALS = [
  trial(0, "feasible", 100, 1),
  trial(1, "pruned", 50, null),
  trial(2, "infeasible", 1000, null),
  trial(3, "feasible", 400, 0.6),
  trial(4, "feasible", 300, 0.8),
];

describe("a study on the page", () => {
  it("names an axis once for all that is set of it", () => {
    expect(namedOnce([])).toBe("");
    expect(namedOnce(["VMAX of axis 0", "GCONF", "AMAX of axis 0", "the microstep table of axis 0 (MSLUT)"])).toBe(
      "VMAX, AMAX of axis 0; GCONF; the microstep table of axis 0 (MSLUT)",
    );
  });

  it("asks for a move with its margin as a share, and for a look without a budget", () => {
    const forms = firstForms(200 * 256);
    const fast = { ...forms.fastest_move, marginPercent: 15, trials: 12 };
    expect(documentOf("fastest_move", { ...forms, fastest_move: fast }, "slide", 1)).toMatchObject({
      device: "slide",
      axis: 1,
      budget: { trials: 12 },
      study: { kind: "fastest_move", seen_by: "encoder", distance: 102_400, margin: 0.15, twin: "as identified" },
    });
    // Without an encoder a switch sees lost steps: moves go away from it.
    const blind = firstForms(1000, false);
    const right = { ...blind.fastest_move, seenBy: "right switch", quiet: true } as const;
    expect(documentOf("fastest_move", { ...blind, fastest_move: right }, "slide", 0)).toMatchObject({
      study: { seen_by: "right switch", distance: -2000, quiet: false, twin: null },
    });
    // Several distances go to the side of the first, which a switch tells.
    expect([furtherOf(""), furtherOf("1, 0.5 2"), furtherOf("1, x"), furtherOf("0")]).toEqual([
      [],
      [1, 0.5, 2],
      null,
      null,
    ]);
    expect(furtherOf("1 2 3 4 5 6 7 8 9")).toBeNull();
    const several = { ...right, distance: 4000, distances: [1000.4, -2000] };
    expect(documentOf("fastest_move", { ...blind, fastest_move: several }, "slide", 0)).toMatchObject({
      study: { distance: -4000, distances: [-1000, -2000] },
    });
    // 1 % takes 299 moves to show: fifteen minutes, as for other studies, would end before.
    const bounded = { ...forms.fastest_move, lossPercent: 1 };
    expect(documentOf("fastest_move", { ...forms, fastest_move: bounded }, "slide", 0)).toMatchObject({
      budget: { trials: 30, time_s: 14_400 },
      study: { loss_rate_max: 0.01 },
    });
    expect(documentOf("first_look", forms, "slide", 0)).toEqual({
      device: "slide",
      axis: 0,
      study: { kind: "first_look", turns: 1, travel_turns: 0 },
    });
  });

  it("tells what each of several distances takes, and nothing of one alone", () => {
    const figures = { ...trial(3, "feasible", 1, 0.7).figures, by_distance_s: [0.2, 0.5, 0.2] };
    const study = {
      document: { study: { kind: "fastest_move", distance: 400, distances: [900, 400] } },
      baseline_figures: { ...figures, by_distance_s: [0.3, 0.8, 0.3] },
      trials: [{ ...trial(3, "feasible", 1, 0.7), figures }],
      best: 3,
    } as unknown as Study;
    expect(timesOf(study)).toEqual([
      { name: "400", before: 0.3, best: 0.2 },
      { name: "900", before: 0.8, best: 0.5 },
      { name: "400 (3)", before: 0.3, best: 0.2 },
    ]);
    expect(timesOf({ ...study, best: null })[0]).toEqual({ name: "400", before: 0.3, best: null });
    expect(timesOf({ ...study, baseline_figures: { ...figures, by_distance_s: [] } } as unknown as Study)).toEqual([]);
  });

  it("asks for the shape of a ramp that the chip can have", () => {
    const forms = firstForms(1000);
    expect(documentOf("fastest_move", forms, "slide", 0).study).toMatchObject({ shape: null });
    const shaped = { ...forms.fastest_move, shape: "six points" } as const;
    expect(documentOf("fastest_move", { ...forms, fastest_move: shaped }, "slide", 0).study).toMatchObject({
      shape: "six points",
    });
    const offered = (has: string) => shapesOf((capability) => capability === has).map(({ value }) => value);
    expect(offered("ramp.sixpoint")).toEqual(["", "six points"]);
    expect(offered("ramp.s")).toEqual(["", "bows"]);
    expect(offered("ramp.pmul")).toEqual([]);
  });

  it("tries a twin first where the motor is known: by its name, or as identified", () => {
    const motor = PLATE;
    expect(twinOf(FIRST_TWIN)).toBe("as identified");
    expect(twinOf({ ...FIRST_TWIN, typed: "17" })).toBe("as identified");
    expect(named(FIRST_TWIN, { ...motor, holding_torque_nm: null })).toBe(FIRST_TWIN);
    const known = named(FIRST_TWIN, motor);
    expect(named(FIRST_TWIN, { ...motor, rotor_inertia_kgm2: 7e-6 }).motor.rotor_inertia_kgm2).toBe(7e-6);
    const figures = {
      holding_torque_nm: 0.59,
      rated_current_a: 2,
      resistance_ohm: 1.4,
      load_inertia_kgm2: 0,
      supply_v: 24,
    };
    expect(twinOf(known)).toEqual({ motor: figures, as_identified: true });
    expect(twinOf({ ...known, on: false })).toBeNull();
    // with what the server knows of the axis: instead of the plate's figures, or instead of all
    expect(takenFrom({ ...FIRST_TWIN, on: false }, true)).toEqual(FIRST_TWIN);
    expect(twinOf(takenFrom(FIRST_TWIN, false))).toEqual({ motor: FIRST_TWIN.motor, as_identified: false });
    expect(twinOf(takenFrom({ ...known, on: false }, true))).toEqual({ motor: figures, as_identified: true });
    expect([isTried(FIRST_TWIN, false), isTried(FIRST_TWIN, true)]).toEqual([false, true]);
  });

  it("tells what a twin was made of, or why none was tried", () => {
    const of = (twin: unknown, no_twin = "") =>
      twinTold({ document: { study: { kind: "fastest_move", twin } }, no_twin } as unknown as Study);
    expect(of({ source: "inertia by study 1" })).toBe("Tried on an emulated twin first: inertia by study 1.");
    expect(of(null, "not identified")).toBe("Not tried on an emulated twin first: not identified.");
    expect([of(null), of({ source: "" })]).toEqual(["", ""]);
  });

  it("fills in what the data base knows of a motor, and what is typed afterwards wins", () => {
    const choice = { typed: "17HS", name: "17HS" };
    const coil = { ...FIRST_COIL, ...coilWith(PLATE, choice) };
    expect(coil).toMatchObject({ motor: choice, resistanceOhm: 1.4, runCurrentA: 2 });
    expect(coil.inductanceMh).toBe(FIRST_COIL.inductanceMh); // not known of it
    expect(coilOf({ ...coil, runCurrentA: 1.2 })).toMatchObject({ resistance_ohm: 1.4, run_current_a: 1.2 });
    expect(torqueFrom(PLATE)).toEqual({ holdingTorqueNm: 0.59, ratedCurrentA: 2 });
    expect(torqueFrom({ ...PLATE, holding_torque_nm: null })).toEqual({});
    // The run current is not known of a motor: where it may be left out it is so, but where the motor was named for this.
    expect(identified(PLATE, choice, true)).toEqual({ motor: choice, holdTorqueNm: 0.59, runCurrentA: 2 });
    expect(identified(PLATE, choice, false)).toEqual({ motor: choice });
    const least = firstForms(1000).least_current;
    expect(cooler(least, PLATE, choice, true)).toMatchObject({
      resistanceOhm: 1.4,
      runCurrentA: 2,
      twin: { name: "17HS" },
    });
    const blank = { ...PLATE, resistance_ohm: null, holding_torque_nm: null };
    expect(cooler(least, blank, choice, false)).toEqual({ motor: choice, twin: FIRST_TWIN });
    const told = /^2.A, 1\.40.Ω, 0\.590.N m, 68.g cm², 200 full steps: a list$/;
    expect(knownOf({ ...PLATE, rotor_inertia_kgm2: 6.8e-6 })).toMatch(told);
  });

  it("tries currents on a twin first, as the fastest move is", () => {
    const forms = firstForms(1000);
    const twin = { ...FIRST_TWIN, on: true };
    const wish = documentOf("least_current", { ...forms, least_current: { ...forms.least_current, twin } }, "slide", 0);
    expect(wish.study).toMatchObject({ kind: "least_current", twin: { motor: FIRST_TWIN.motor } });
    expect(documentOf("least_current", forms, "slide", 0).study).toMatchObject({ twin: "as identified" });
  });

  it("tells a figure in a unit of its size, and how sure it is", () => {
    const found = { name: "", text: "", sure: "measured", remedy: null } as const;
    const of = (value: number | null, unit: string, low = 0, high = 0) =>
      figureOf({ ...found, value, unit, interval: high ? { low, high } : null } as Finding);
    expect(of(4.4e-3, "H", 4.1e-3, 4.7e-3)).toEqual({ figure: "4.400 mH", sure: "95 %: 4.100 to 4.700" });
    expect(of(5.8e-6, "kg m2").figure).toBe("58.00 g cm²");
    expect(of(null, "Hz")).toEqual({ figure: "", sure: "" });
  });

  it("parts a long verdict into what came of it and its grounds", () => {
    const told =
      "30 % faster (0.4 s to 0.3 s; 95 %: 1 to 2 ms less), no step lost; it is 1.5 ms. With CoolStep (SEMIN 2)";
    expect(sentencesOf(told)).toEqual([
      "30 % faster (0.4 s to 0.3 s; 95 %: 1 to 2 ms less), no step lost",
      "it is 1.5 ms",
      "With CoolStep (SEMIN 2)",
    ]);
    expect(sentencesOf("running")).toEqual(["running"]);
  });

  it("asks for a calibration, whose form a link may open", () => {
    const forms = firstForms(null);
    expect(documentOf("microstep_calibration", forms, "slide", 0)).toEqual({
      device: "slide",
      axis: 0,
      budget: { time_s: 3600 },
      study: { kind: "microstep_calibration", turns: 1, velocity_rps: 0.05, pairs: 6, keep: false },
    });
  });

  it("asks for margins and draws the open loop over the logarithm of the frequency", () => {
    const forms = firstForms(null);
    expect(documentOf("closed_loop", forms, "slide", 0).study).toMatchObject({ phase_margin_deg: 60, gain_margin: 2 });
    expect(documentOf("identification", forms, "slide", 0).study).toMatchObject({ hops: 24, hold_torque_nm: null });
    const loop = { open_loop: { frequency_hz: [1, 10, 100], gain_db: [20, 0, -40], phase_deg: [-120, -110, -250] } };
    expect(bodeOf(loop as Loop)[0]).toEqual([0, 1, 2]);
    expect(nicholsOf(loop as Loop).data[0]).toEqual([-250, -110]);
    expect(tensTicks([0, 2])).toEqual(["1", "100"]);
  });

  it("draws the error of each measurement over the electrical angle, and harmonics that are more than noise", () => {
    const harmonic = (order: number, amplitude: number) => ({
      order,
      sine_deg: amplitude,
      cosine_deg: 0,
      amplitude_deg: amplitude,
      half_deg: 0.1,
    });
    const figures = (curve: number[], ...amplitudes: number[]) => ({
      curve_deg: curve,
      harmonics: amplitudes.map((amplitude, index) => harmonic(index + 1, amplitude)),
    });
    const found = {
      before: figures([1, -1], 0.05, 2, 0.05),
      predicted_deg: [0.1, -0.1],
      after: null,
      wave_before: [0, 1],
      wave: null,
    } as unknown as Microsteps;
    expect(errorOf(found)).toEqual([
      [90, 270],
      [1, -1],
      [0.1, -0.1],
      [null, null],
    ]);
    expect(addedOf({ ...found, wave: [0, 3] })).toEqual([
      [0, 1],
      [0, 2],
    ]);
    expect(harmonicsOf(found)).toEqual([{ order: 2, before: 2, beforeHalf: 0.1, after: null, afterHalf: null }]);
    const after = { ...found, after: figures([0, 0], 0.05, 0.05, 0.3) } as unknown as Microsteps;
    expect(harmonicsOf(after).map(({ order, after: now }) => [order, now])).toEqual([
      [2, 0.05],
      [3, 0.3],
    ]);
  });

  it("asks for a threshold at speeds as they were typed, rising and each once", () => {
    const forms = firstForms(null);
    const typed = { ...forms.stallguard, speeds: "2; 0.5 1,,x 1", confirmed: true };
    expect(documentOf("stallguard", { ...forms, stallguard: typed }, "slide", 0).study).toMatchObject({
      kind: "stallguard",
      speeds_rps: [0.5, 1, 2],
      stop_confirmed: true,
      each_speed: true,
    });
  });

  it("asks for torque over speed, and draws it, or the acceleration where the inertia is not known", () => {
    const forms = firstForms(null);
    const study = {
      kind: "torque_curve",
      seen_by: "encoder",
      travel_turns: 60,
      inertia_kgm2: null,
      inertia_share: 0.05,
    };
    expect(documentOf("torque_curve", forms, "slide", 0).study).toMatchObject(study);
    expect(goalsOf(false).map(({ value }) => value)).toEqual(["first_look", "fastest_move", "torque_curve"]);
    expect(firstForms(null, false).torque_curve.seenBy).toBe("left switch");
    const point = {
      speed_rps: 2,
      acceleration_radps2: 100,
      interval_radps2: { low: 90, high: 110 },
      torque_nm: 0.1,
      interval_nm: { low: 0.09, high: 0.11 },
    } as TorquePoint;
    expect(curveOf(rowsOf([point]))).toEqual([[2], [0.1], [0.09], [0.11]]);
    expect(curveOf(rowsOf([{ ...point, torque_nm: null }]))).toEqual([[2], [100], [90], [110]]);
  });

  it("asks for a calmer chopper, and draws what was tried apart from the setting before", () => {
    const study = { kind: "chopper", inductance_h: 0.0044, speeds_rps: [0.25, 0.5, 1], lowest_hz: 20_000 };
    const document = documentOf("chopper", firstForms(null), "slide", 0);
    expect(document.study).toMatchObject(study);
    expect(document.budget).toMatchObject({ trials: 60 });
    const one = { off: 3, blank: 1, hysteresis: 4, ripple_fullsteps: 0.02 } as ChopperTried;
    const before = { ...one, hysteresis: -2, ripple_fullsteps: 0.05 };
    expect(rippleOf({ before, tried: [one, { ...one, hysteresis: 0, ripple_fullsteps: 0.03 }] })).toEqual([
      [-2, 0, 4],
      [null, 0.03, 0.02],
      [0.05, null, null],
    ]);
    const found = { before, calculated: one, chosen: null } as unknown as ChopperFound;
    expect(namedOf(found).map(([name]) => name)).toEqual(["before", "calculated"]);
  });

  it("asks for StealthChop, and draws the jolt over the switch-over speed beside what is allowed", () => {
    const study = { kind: "stealthchop", holding_torque_nm: null, velocity_max_rps: 3, jolt_max_fullsteps: 0.5 };
    expect(documentOf("stealthchop", firstForms(null), "slide", 0).study).toMatchObject(study);
    const one = { offset: 24, gradient: 12, on: true, switch_rps: 0.8, jolt_fullsteps: 0.6 } as StealthTried;
    const before = { ...one, switch_rps: 0.4, jolt_fullsteps: 0.3 };
    const never = { ...one, on: false };
    expect(joltsOf({ before, tried: [one, never], jolt_max_fullsteps: 0.5 })).toEqual([
      [0.4, 0.8],
      [null, 0.6],
      [0.3, null],
      [0.5, 0.5],
    ]);
    expect([one, { ...one, switch_rps: null }, never].map((each) => reachOf(each, String))).toEqual([
      "0.8 turns/s",
      "every speed",
      "never",
    ]);
  });

  it("asks for less current, and draws what held apart from what lost steps", () => {
    const study = {
      kind: "least_current",
      distance: 102_400,
      margin: 0.25,
      speed_margin: 0.25,
      loss_rate_max: 0.05,
      run_current_a: null,
      coolstep: true,
    };
    expect(documentOf("least_current", firstForms(null), "slide", 0).study).toMatchObject(study);
    const tried = [
      { scale: 15, share: 0.5, held: true, cycles: 3, speed_times: 1, deviation_fullsteps: 0.6 },
      { scale: 7, share: 0.25, held: false, cycles: 1, speed_times: 1, deviation_fullsteps: 4 },
    ];
    expect(triedOf({ tried })).toEqual([
      [8, 16],
      [null, 0.6],
      [4, null],
    ]);
  });

  it("tells rates with their bounds, and draws what each threshold would do", () => {
    expect(rateText({ wrong: 0, runs: 299, most: 0.00997 })).toBe("0 of 299: below 1.00\u202f%");
    expect(rateText(null)).toBe("not tried");
    const alone = {
      threshold: -8,
      filtered: true,
      level: 64,
      false: 0,
      free_runs: 100,
      missed: 1,
      stops: 20,
      may_do: true,
    };
    expect(aloneText(alone)).toBe("-8 with the filter: 0 of 100 false, 1 of 20 missed");
    expect(aloneText({ ...alone, filtered: false, may_do: false })).toBe(
      "-8: 0 of 100 false, 1 of 20 missed, too many",
    );
    expect(aloneText(null)).toBe("");
    const own = { threshold: 3, filtered: true, level: -24, from_pps: 900, trial: 1 };
    const proved = {
      trials: [{ number: 0, setting: { threshold: -8, filter: 0 } }],
      best: 0,
    } as unknown as Study;
    const at = (more: Partial<StallSpeed>) => ({ own: null, why: "", ...more }) as StallSpeed;
    expect(thresholdText(at({}), proved)).toBe("-8");
    expect(thresholdText(at({ own, why: "not with that of the others" }), proved)).toBe("3 with the filter, its own");
    expect(thresholdText(at({ why: "no threshold does it here" }), proved)).toBe("");
    expect(thresholdText(at({}), { ...proved, best: null })).toBe("");
    const roc = [
      { level: -90, false: 0, missed: 0.5 },
      { level: 10, false: 0.25, missed: 0 },
    ];
    expect(rocOf({ roc } as unknown as StallSpeed)).toEqual([
      [0, 0, 0.25, 1],
      [1, 0.5, 0, 0],
    ]);
  });

  it("draws moves over one time, until the slowest has arrived, and nothing where there is none", () => {
    const slow = { which: "before", time_s: [0, 1, 2, 3, 9], fullsteps: [0, 50, 100, 100, 100] } as const;
    const fast = { which: "best", time_s: [0.1, 0.5, 1], fullsteps: [0, 100, 100] } as const;
    const moves = [slow, fast].map((move) => ({ ...move, time_s: [...move.time_s], fullsteps: [...move.fullsteps] }));
    expect(at(moves[0] as (typeof moves)[0], 0.5)).toBe(25);
    expect(at(moves[1] as (typeof moves)[0], 0.05)).toBeNull();
    const [times, before, best, present] = movesOf(moves, ["before", "best", "present"]);
    expect(Array.from(times).at(-1)).toBeCloseTo(1.15);
    expect(Array.from(before ?? []).at(-1)).toBeCloseTo(57.5);
    expect(Array.from(best ?? []).at(-1)).toBeNull();
    expect(new Set(Array.from(present ?? []))).toEqual(new Set([null]));
  });

  it("offers the front of two objectives", () => {
    const choices = choicesOf({ trials: TRIALS, front: [0, 3] } as unknown as Study);
    expect(choices.map(({ number }) => number)).toEqual([3, 0]);
    expect(nearestOf(choices, 0.75)?.number).toBe(3);
    expect(nearestOf(choices, 0.85)?.number).toBe(0);
    expect(nearestOf([], 1)).toBeUndefined();
  });

  it("has one setting of a front proved by a study of its own", () => {
    const forms = firstForms(1000);
    const quiet = { ...forms.fastest_move, quiet: true, deviationMax: 0.5, sampler: "cmaes" } as const;
    const wish = documentOf("fastest_move", { ...forms, fastest_move: quiet }, "slide", 1);
    expect(wish.study).toMatchObject({ quiet: true, deviation_max_fullsteps: 0.5, sampler: null });
    const one = { ...quiet, quiet: false };
    expect(documentOf("fastest_move", { ...forms, fastest_move: one }, "slide", 1).study).toMatchObject({
      quiet: false,
      deviation_max_fullsteps: null,
      sampler: "cmaes",
    });
    const study = { id: "20260101-120000", document: wish } as unknown as Study;
    expect(proofOf(study, TRIALS[3] as Trial)).toMatchObject({
      device: "slide",
      axis: 1,
      name: "Proof of trial 3 of 20260101-120000",
      study: {
        kind: "fastest_move",
        quiet: true,
        candidate: { speed: 400 },
        deviation_max_fullsteps: null,
        twin: null,
      },
    });
  });

  it("asks for an own search, and offers settings with what they take", () => {
    const about = { unit: "pps^2", low: 0, high: 250_000, now: 200_001.5, one: 116, group: "ramp", help: "" };
    const ramp: Searchable = { ...about, name: "AMAX" };
    const off: Searchable = { ...about, name: "CHOPCONF.toff", unit: "", low: 1, high: 15, now: 3, one: 1 };
    expect(presetOf(ramp)).toEqual({ name: "AMAX", unit: "pps^2", low: 100_000, high: 250_000, log: true });
    expect(presetOf(off)).toEqual({ name: "CHOPCONF.toff", unit: "", low: 1, high: 15, log: false });
    const forms = firstForms(51_200);
    const own = { ...forms.custom_search, settings: [presetOf(ramp), presetOf(off)], timeMost: 0.5 };
    const { study } = documentOf(
      "custom_search",
      { ...forms, custom_search: { ...own, second: "time_s" } },
      "slide",
      0,
    );
    expect(study).toMatchObject({
      space: [
        { name: "AMAX", low: 100_000, high: 250_000, log: true },
        { name: "CHOPCONF.toff", low: 1, high: 15, log: false },
      ],
      distances: [51_200],
      objectives: ["peak_fullsteps", "time_s"],
      bounds: [{ figure: "time_s", most: 0.5 }],
      more_current: false,
    });
  });

  it("tells whether an own search is shown to be better", () => {
    const effect = {
      figure: "peak_fullsteps",
      unit: "full steps",
      baseline: 0.4,
      winner: 0.2,
      difference: -0.2,
      p: 0.002,
    };
    const effects = [{ ...effect, interval: { low: -0.3, high: -0.1 }, significant: true, worse: false }];
    expect(evidenceRows({ effects } as unknown as CustomFound)[0]?.at(-1)).toBe("better");
  });

  it("draws a Campbell plot: each order's frequency at each speed, the strongest dot on top", () => {
    const point = { ripple_deg: 1, interval_deg: null, rest_deg: 0, rest_hz: null, runs: 2, lost: 0, blind: 0 };
    const found: ResonanceFound = {
      orders: [2, 4],
      points: [
        { ...point, speed_rps: 0.5, electrical_hz: 25, amplitudes_deg: [1, 16] },
        { ...point, speed_rps: 2, electrical_hz: 100, amplitudes_deg: [null, 4] },
        { ...point, speed_rps: 3, electrical_hz: 0, amplitudes_deg: [null, null], lost: 2, runs: 0 },
      ],
      resonance_hz: { value: 100, interval: { low: 99, high: 101 } },
      damping_ratio: null,
      told_by: [4],
      crossings: [],
      changes: [],
    };
    const plot = campbellOf(found);
    expect(plot?.dots.map(({ order, speed, level }) => [order, speed, level])).toEqual([
      [2, 0.5, 0.25],
      [4, 2, 0.5],
      [4, 0.5, 1],
    ]);
    const [weak, other, strong] = plot?.dots ?? [];
    if (!plot || !weak || !other || !strong) throw new Error("three dots");
    expect(plot.resonance).toBeCloseTo(strong.y);
    expect(colourOf(strong)).toBe("#fee838");
    expect(saidOf(strong)).toBe("order 4 at 0.500 turns/s, 100\u202fHz: 16°");
    expect(walked(plot.dots, null, "ArrowUp")).toBe(strong);
    expect(walked(plot.dots, strong, "ArrowDown")).toBe(weak);
    expect(walked(plot.dots, weak, "ArrowRight")).toBe(weak);
    expect(walked(plot.dots, strong, "ArrowRight")).toBe(other);
    expect(campbellOf({ ...found, points: [] })).toBeNull();
    const compared = { before_deg: 3, after_deg: 1, difference_deg: -2, interval_deg: { low: -3, high: -1 } };
    const points = [{ ...compared, speed_rps: 0.5, told: "quieter" as const }];
    const change = { name: "x", trial: 1, points, lost_rps: [], resonance_hz: null, p: null, quieter: true };
    expect(changeOf({ ...change, before_deg: 3, difference_deg: -2, interval_deg: null })).toEqual([[0.5], [3], [1]]);
  });

  it("ranks moves by hand: those that lost steps last, and tells what taking one changes", () => {
    const move = (id: string, speed: number, time: number | null, lost = 0) =>
      ({
        id,
        started_unix_s: Number(id),
        setting: { speed, TOFF: 3 },
        scored: { time_s: time, lost_fullsteps: lost, distance: Number(id) % 2 ? 512 : -256, stalls: 0 },
      }) as unknown as Move;
    const moves = [move("1", 100, 2), move("2", 400, 0.5, 4), move("3", 200, 1), move("4", 300, null)];
    expect(ranked(moves, "time_s").map(({ id }) => id)).toEqual(["3", "1", "4", "2"]);
    expect(changedIn(moves)).toEqual(["speed"]);
    expect(distancesOf(moves)).toEqual([256, 512]);
    const [first, , third] = moves as [Move, Move, Move, Move];
    expect(differences(first, third)).toEqual([["speed", 200, 100]]);
    expect(differences(first, first)).toEqual([]);
  });

  it("ranks moves by their load, and those that a stall ended by how far they came", () => {
    const move = (id: string, load: number | null, reached = 1, lost = 0) =>
      ({
        id,
        started_unix_s: Number(id),
        setting: { SGT: Number(id), ...(id === "1" ? {} : { SEMIN: 3 }) },
        scored: {
          time_s: 1,
          load_min: load,
          load_margin: load,
          reached,
          stalls: reached < 1 ? 1 : 0,
          lost_fullsteps: lost,
        },
      }) as unknown as Move;
    const moves = [move("1", 90), move("2", 20, 0.3), move("3", 200), move("4", 40, 0.75), move("5", 40, 0.5, 4)];
    for (const by of ["load_min", "load_margin"] as const)
      expect(ranked(moves, by).map(({ id }) => id)).toEqual(["3", "1", "4", "2", "5"]);
    expect(ranked(moves, "reached").map(({ id }) => id)).toEqual(["1", "3", "4", "2", "5"]);
    expect(moves.map(endedBy)).toEqual(["", "stall at 30 %", "", "stall at 75 %", "stall at 50 %, steps lost"]);
    // What is not known of an older move was not changed.
    expect(changedIn(moves)).toEqual(["SGT"]);
    const [first, second] = moves as [Move, Move];
    expect(differences(first, second)).toEqual([["SGT", 2, 1]]);
  });

  it("makes a cure's address whole", () => {
    const remedy = { label: "write", method: "POST" as const, path: "registers", body: {}, moves: true };
    const finding = { remedy } as unknown as Study["findings"][number];
    expect(remedyOf("a b", finding)?.path).toBe("/api/v1/devices/a%20b/registers");
    expect(remedyOf("a", { ...finding, remedy: null })).toBeNull();
  });
});
