import { describe, expect, it } from "vitest";
import { dcVelocity, slowestClocks, syncQuestion } from "./question";

const MOTOR = { clockHz: 16e6, fullStepsPerRev: 200, wantedHz: null };

function chip(values: Readonly<Record<string, number>>) {
  return { planned: (register: string, field?: string) => values[field ?? register] ?? null };
}

describe("what is asked of chopSync and dcStep", () => {
  it("counts as after power-on where it cannot be read", () => {
    expect(syncQuestion(chip({}), MOTOR)).toMatchObject({
      chopsync_div: 640,
      dc_lsptm: 0xffffff,
      dcstep_mode: 0,
      microsteps: 256,
    });
  });

  it("is what is planned", () => {
    const planned = chip({ mstep_per_fs: 4, VMAX: -25_600, DC_TIME: 80, dcstep_mode: 3, CHOPSYNC_DIV: 0x1280 });
    expect(syncQuestion(planned, { ...MOTOR, wantedHz: 36e3 })).toMatchObject({
      microsteps: 16,
      v_max_pps: 100,
      dc_time: 80,
      dcstep_mode: 3,
      chopsync_div: 0x280, // the register is as wide as that of PWM
      wanted_hz: 36e3,
    });
  });
});

describe("registers from figures", () => {
  it("are rounded and kept in their widths", () => {
    expect(slowestClocks(40, 16e6)).toBe(400_000);
    expect(slowestClocks(1e-9, 16e6)).toBe(2 ** 32 - 1);
    expect(dcVelocity(120, 256, 200)).toBe(102_400);
    expect(dcVelocity(1e9, 256, 200)).toBe(2 ** 24 - 1);
  });
});
