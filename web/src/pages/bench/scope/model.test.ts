import { describe, expect, it } from "vitest";
import { about } from "../../../../test/catalog";
import type { Device } from "../../../api/queries";
import { buildRows, requestsFor, valueText } from "./model";
import { furtherOf, ROWS } from "./rows";
import type { ScopeSettings } from "./settings";

function device(id: string, axes: number, rate: number): Device {
  return {
    id,
    name: id.toUpperCase(),
    model: "tmc428",
    about: about("tmc428"),
    title: "",
    link: {},
    clock_hz: 16e6,
    state: "connected",
    heldBack: false,
    problem: null,
    notes: [],
    emulated: true,
    demo: true,
    start_up: false,
    drivers: [],
    axes: Array.from({ length: axes }, (_, index) => ({
      index,
      name: "xyz"[index] ?? "",
      full_steps_per_rev: 200,
      driver_microsteps: 16,
      gear_ratio: 1,
      travel_mm_per_rev: 8,
      limits: {
        position_min: null,
        position_max: null,
        velocity_max_pps: null,
        acceleration_max_pps2: null,
        current_max_a: null,
        current_full_scale_a: null,
        sense_resistor_ohm: null,
      },
      lost_steps_microsteps: null,
      following_error_microsteps: null,
      limit_warnings: [],
      microsteps_per_full_step: 64,
      pulse_div: 5,
      ramp_div: 7,
      rates_known: true,
    })),
    channels: Array.from({ length: axes }, (_, axis) =>
      ROWS.flatMap((row) => row.channels).map(({ quantity }) => ({
        name: `${quantity}.${axis}`,
        quantity,
        axis,
        unit: "",
      })),
    ).flat(),
    rate_max_hz: rate,
    chip_timed: true,
  };
}

const DEVICES = [device("a", 3, 1000), device("b", 1, 200)];
const SETTINGS: ScopeSettings = {
  spanS: 10,
  rateHz: 1000,
  unit: "mm",
  trigger: "roll",
  rows: ROWS.map((row) => row.id),
  hidden: ["target_position"],
  extras: [{ device: "b", axis: 0 }],
  more: [],
  folds: {},
  free: [],
  derived: {},
  marks: false,
};

describe("the scope's model", () => {
  it("asks each device once, no faster than it can, for channels that it has", () => {
    const [main, other, ...more] = requestsFor(DEVICES, { device: "a", axis: 1 }, SETTINGS);
    expect(main).toMatchObject({ device: "a", rateHz: 1000 });
    expect(main?.channels).toContain("residual.1");
    expect(main?.channels).not.toContain("position.0");
    expect(other).toMatchObject({ device: "b", rateHz: 200 });
    expect(other?.channels).toEqual(["position.0", "velocity.0", "acceleration.0"]);
    expect(more).toEqual([]);
  });

  it("shows the selected axis in its unit, and added axes as dashed lines of the same colour", () => {
    const rows = buildRows(DEVICES, { device: "a", axis: 1 }, SETTINGS, "light");
    const position = rows.find(({ row }) => row.id === "position");
    expect(position?.unit).toBe("mm");
    const own = position?.traces.find((trace) => trace.key === "position");
    const added = position?.traces.find((trace) => trace.device === "b");
    expect(own?.divisor).toBe(1600);
    expect(added?.series.dash).toBeDefined();
    expect(added?.series.color).toBe(own?.series.color);
    expect(position?.traces.find((trace) => trace.quantity === "target_position")?.series.hidden).toBe(true);
    expect(own && valueText(own, 800)).toBe("0.5000");
  });

  it("shows any register or parameter that was chosen, and asks for it", () => {
    const plain = device("a", 1, 1000);
    const named = ["TOFF", "GainP"].map((quantity) => ({ name: `${quantity}.0`, quantity, axis: 0, unit: "" }));
    const listed = { ...plain, channels: [...plain.channels, ...named] };
    expect(furtherOf(listed, 0)).toEqual(["TOFF", "GainP"]);
    const chosen: ScopeSettings = { ...SETTINGS, rows: ["position"], extras: [], more: ["GainP", "gone"] };
    const more = buildRows([listed], { device: "a", axis: 0 }, chosen, "light").find(({ row }) => row.id === "more");
    expect(more?.traces.map(({ channel, shown }) => [channel, shown])).toEqual([["GainP.0", true]]);
    const [request] = requestsFor([listed], { device: "a", axis: 0 }, chosen);
    expect(request?.channels).toContain("GainP.0");
    expect(request?.channels).not.toContain("TOFF.0");
  });

  it("shows what was chosen of a device without any axis", () => {
    const bare: Device = {
      ...device("c", 0, 1000),
      channels: [{ name: "GCONF.0", quantity: "GCONF", axis: 0, unit: "" }],
    };
    const main = { device: "c", axis: 0 };
    expect(buildRows([bare], main, { ...SETTINGS, extras: [] }, "light")).toEqual([]);
    const chosen: ScopeSettings = { ...SETTINGS, extras: [], more: ["GCONF"] };
    const [row, ...others] = buildRows([bare], main, chosen, "light");
    expect(row?.traces.map(({ channel }) => channel)).toEqual(["GCONF.0"]);
    expect(others).toEqual([]);
    expect(requestsFor([bare], main, chosen).map(({ channels }) => channels)).toEqual([["GCONF.0"]]);
  });

  it("asks a module's wire for nothing that is not on show", () => {
    const module: Device = { ...device("m", 1, 100), model: "pd42-1241", about: about("pd42-1241") };
    const shown: ScopeSettings = { ...SETTINGS, rows: ["position", "load"], extras: [] };
    const [request] = requestsFor([module], { device: "m", axis: 0 }, shown);
    expect(request?.channels).toContain("load_value.0");
    expect(request?.channels).toContain("encoder_position.0");
    for (const hidden of ["target_position.0", "velocity.0", "switch_left.0"])
      expect(request?.channels).not.toContain(hidden);
  });

  it("has a plot and a lane only for what the axis has", () => {
    const chip = { ...device("a", 1, 1000) };
    chip.channels = chip.channels.filter(({ quantity }) =>
      ["position", "switch_left", "switch_reference"].includes(quantity),
    );
    const rows = buildRows([chip], { device: "a", axis: 0 }, SETTINGS, "light");
    expect(rows.map(({ row }) => row.id)).toEqual(["position", "switches"]);
    expect(rows[1]?.row.channels).toHaveLength(2);
    expect(rows[1]?.traces[1]?.offset).toBeLessThan(1);
    const load = buildRows([device("b", 1, 10)], { device: "b", axis: 0 }, SETTINGS, "light").find(
      ({ row }) => row.id === "load",
    )?.traces[0];
    expect(load && valueText(load, 412)).toBe("412");
  });

  it("falls back to chip units where the axis knows no better, and says on and off", () => {
    const bare = { ...device("a", 1, 1000) };
    bare.axes = bare.axes.map((axis) => ({ ...axis, microsteps_per_full_step: null }));
    const rows = buildRows([bare], { device: "a", axis: 0 }, SETTINGS, "dark");
    expect(rows.map(({ unit }) => unit)).toEqual([
      "microsteps",
      "microsteps",
      "microsteps",
      "pps",
      "pps2",
      "",
      "deg",
      "",
      "",
      "",
    ]);
    const lamp = rows.at(-1)?.traces[0];
    expect(lamp && [valueText(lamp, 1), valueText(lamp, 0), valueText(lamp, Number.NaN)]).toEqual(["on", "off", "–"]);
  });
});
