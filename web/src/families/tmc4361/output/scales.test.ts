import { describe, expect, it } from "vitest";
import { moveOf, pwmOf, rowsOf, scalesOf } from "./scales";

function chipOf(values: Record<string, number>) {
  return {
    planned: (register: string, field?: string) =>
      values[field === undefined ? register : `${register}.${field}`] ?? null,
  };
}

const CURRENT = {
  "CURRENT_CONF.hold_current_scale_en": 1,
  "CURRENT_CONF.drive_current_scale_en": 1,
  "CURRENT_CONF.boost_current_on_acc_en": 0,
  "CURRENT_CONF.boost_current_on_dec_en": 0,
  "CURRENT_CONF.boost_current_after_start_en": 1,
  "CURRENT_CONF.sec_drive_current_scale_en": 0,
  "CURRENT_CONF.freewheeling_en": 0,
  "SCALE_VALUES.boost_scale_val": 200,
  "SCALE_VALUES.drv1_scale_val": 150,
  "SCALE_VALUES.drv2_scale_val": 120,
  "SCALE_VALUES.hold_scale_val": 60,
  VDRV_SCALE_LIMIT: 1000,
  UP_SCALE_DELAY: 1,
  HOLD_SCALE_DELAY: 2,
  DRV_SCALE_DELAY: 3,
  BOOST_TIME: 4,
  STDBY_DELAY: 5,
  FREEWHEEL_DELAY: 6,
};

describe("current scales", () => {
  it("takes every setting from its own place in the chip", () => {
    expect(scalesOf(chipOf(CURRENT))).toEqual({
      hold_en: true,
      drive_en: true,
      boost_on_acceleration: false,
      boost_on_deceleration: false,
      boost_after_start: true,
      drive_2_en: false,
      freewheeling_en: false,
      boost: 200,
      drive: 150,
      drive_2: 120,
      hold: 60,
      drive_2_above_pps: 1000,
      up_delay: 1,
      hold_delay: 2,
      drive_delay: 3,
      boost_time: 4,
      standby_delay: 5,
      freewheel_delay: 6,
    });
  });

  it("waits for what is not known", () => {
    const { STDBY_DELAY: _, ...rest } = CURRENT;
    expect(scalesOf(chipOf(rest))).toBeNull();
  });

  it("plans with the chip's ramp, and with one of its own where that is none", () => {
    const ramp = {
      ...Object.fromEntries(["BOW1", "BOW2", "BOW3", "BOW4"].map((name) => [name, 4e6])),
      ...Object.fromEntries(["VSTART", "VSTOP", "VBREAK", "ASTART", "DFINAL"].map((name) => [name, 0])),
      ...{ VMAX: 20_000 * 256, AMAX: 400_000, DMAX: 400_000, "RAMPMODE.RAMP_PROFILE": 2 },
    };
    const own = moveOf(chipOf(ramp), 16e6);
    expect(own.assumed).toBe(false);
    expect(own.parameters).toMatchObject({ vmax: 20_000, amax: 100_000, bow1: 4e6, ramp_mode: "position" });
    expect(moveOf(chipOf({}), 16e6).assumed).toBe(true);
  });

  it("says how far the scale gets", () => {
    const stretch = { start_s: 0, end_s: 1, wanted: 200 };
    expect(
      rowsOf({
        stretches: [
          { ...stretch, situation: "boost", scale_from: 60, scale_to: 180 },
          { ...stretch, situation: "hold", scale_from: 60, scale_to: 60 },
          { ...stretch, situation: "freewheeling", scale_from: 60, scale_to: 60 },
        ],
      }).map(({ scale }) => scale),
    ).toEqual(["60 to 180", "60", "off"]);
  });

  it("asks for no duty without a period", () => {
    const chip = { PWM_FREQ: 640, PWM_VMAX: 9, "CURRENT_CONF.pwm_ampl": 8, "CURRENT_CONF.pwm_scale_en": 1 };
    expect(pwmOf(chipOf(chip), 16e6, 7)).toMatchObject({
      period_clocks: 640,
      amplitude: 8,
      full_at_pps: 9,
      scales: true,
    });
    expect(pwmOf(chipOf({ ...chip, PWM_FREQ: 0 }), 16e6, 0)).toBeNull();
  });
});
