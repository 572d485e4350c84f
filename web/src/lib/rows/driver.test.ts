import { describe, expect, it } from "vitest";
import { parameterFor, parameterOf, rawOf } from "./driver";
import { register } from "./samples";

const SPEED = { unit: "pps", minimum: 0, maximum: 7_999_774, internal_range: [0, 8_388_096] };
const place = (name: string, field = "", step = 1, offset = 0) => ({ driver: { name, field, step, offset } });
const ROWS = [
  register("maximum_current", 32, { ...place("IHOLD_IRUN", "IRUN", 8), minimum: 0, maximum: 255 }),
  register("chopper_hysteresis_start", 32, { ...place("CHOPCONF", "hstrt", 1, 1), minimum: 0, maximum: 8 }),
  register("maximum_positioning_speed", 32, { ...place("VMAX"), ...SPEED }),
  register("smartenergy_threshold_speed", 32, { ...place("TCOOLTHRS"), ...SPEED }),
  register("maximum_acceleration", 32, {
    ...place("AMAX"),
    ...{ unit: "pps^2", minimum: 117, maximum: 7_629_278, internal_range: [1, 65_535] },
  }),
];
const PPS = { clockHz: 16e6, microsteps: 256, inPps: true };
const CHIP = { ...PPS, inPps: false };

function row(name: string, field = "") {
  const found = parameterFor(ROWS, name, field);
  if (!found) throw new Error(`no parameter sets ${name}.${field}`);
  return found;
}

describe("parameters as registers of the driver chip", () => {
  it("counts currents in 32 steps of 8, and the hysteresis from 1", () => {
    expect(rawOf(row("IHOLD_IRUN", "IRUN"), 255, PPS)).toBe(31);
    expect(rawOf(row("IHOLD_IRUN", "IRUN"), 128, PPS)).toBe(16);
    expect(parameterOf(row("IHOLD_IRUN", "IRUN"), 16, PPS)).toBe(128);
    expect(rawOf(row("CHOPCONF", "hstrt"), 5, PPS)).toBe(4);
    expect(parameterOf(row("CHOPCONF", "hstrt"), 4, PPS)).toBe(5);
  });

  it("makes pps of the ramp's units, and leaves them alone in unit mode 0", () => {
    expect(rawOf(row("VMAX"), 51_200, PPS)).toBe(53_687);
    expect(rawOf(row("AMAX"), 51_200, PPS)).toBe(440);
    expect(parameterOf(row("AMAX"), 1, PPS)).toBe(117); // what the module allows at least
    expect(rawOf(row("VMAX"), 53_687, CHIP)).toBe(53_687);
    expect(parameterOf(row("VMAX"), 53_687, CHIP)).toBe(53_687);
  });

  it("makes clocks between steps of the speed of a threshold, and 0 of never", () => {
    expect(rawOf(row("TCOOLTHRS"), 50_000, PPS)).toBe(320);
    expect(parameterOf(row("TCOOLTHRS"), 320, PPS)).toBe(50_000);
    expect(rawOf(row("TCOOLTHRS"), 0, PPS)).toBe(2 ** 20 - 1);
    expect(parameterOf(row("TCOOLTHRS"), 2 ** 20 - 1, PPS)).toBe(0);
    expect(rawOf(row("TCOOLTHRS"), 52_429, CHIP)).toBe(320);
  });
});
