"""The current scale over a motion against the emulated chip, over random settings; and what the page says of it."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

from app.calc.ramps.sramp import SRamp, position_plan, velocity_plan
from app.calc.tmc4361.current_scale import CurrentSettings, course, findings
from app.calc.tmc4361.pwm import PwmSettings
from app.emulators.drive.table import PEAK
from app.emulators.tmc4361.feedback import FeedbackOptions
from app.emulators.tmc4361.feedback import layout as fl
from app.emulators.tmc4361.registers import Chip

CLOCK_HZ = 16e6
BRISK = SRamp(vmax=20_000.0, amax=400_000.0, dmax=400_000.0, bow1=8e6, bow2=8e6, bow3=8e6, bow4=8e6)
TICK = 128
"""Clocks from one look of the emulator at its scale to the next."""
FLAGS = (
    "hold_en", "drive_en", "boost_on_acceleration", "boost_on_deceleration", "boost_after_start", "drive_2_en",
    "freewheeling_en",
)  # fmt: skip
"""As CURRENT_CONF has them, from bit 0."""
LATE = 8 * TICK
"""The emulated ramp starts and passes a speed up to so many clocks beside the plan."""


def settings_of(rng: random.Random) -> CurrentSettings:
    def delay() -> int:
        return rng.choice((0, rng.randrange(1, 400), rng.randrange(400, 20_000)))

    def flag() -> bool:
        return rng.random() < 0.5

    numbers: dict[str, Any] = {
        **{name: rng.randrange(256) for name in ("boost", "drive", "drive_2", "hold")},
        "drive_2_above_pps": rng.randrange(0, 60_000),
        "up_delay": delay(),
        "hold_delay": delay(),
        "drive_delay": delay(),
        "boost_time": rng.randrange(0, 1_500_000),
        "standby_delay": rng.randrange(0, 800_000),
        "freewheel_delay": rng.randrange(0, 800_000),
    }
    flags: dict[str, Any] = {name: flag() for name in FLAGS}
    return replace(CurrentSettings(), **numbers, **flags)


def programmed(chip: Chip, settings: CurrentSettings, ramp: SRamp) -> None:
    words = {
        0x05: sum(getattr(settings, name) << at for at, name in enumerate(FLAGS)),
        0x06: settings.boost | settings.drive << 8 | settings.drive_2 << 16 | settings.hold << 24,
        0x15: settings.standby_delay,
        0x16: settings.freewheel_delay,
        0x17: settings.drive_2_above_pps,
        0x18: settings.up_delay,
        0x19: settings.hold_delay,
        0x1A: settings.drive_delay,
        0x1B: settings.boost_time,
        0x20: 6,
        0x28: round(ramp.amax * 4),
        0x29: round(ramp.dmax * 4),
        **{0x2D + n: round(bow) for n, bow in enumerate((ramp.bow1, ramp.bow2, ramp.bow3, ramp.bow4))},
        0x24: round(ramp.vmax * 256),
    }
    for address, word in words.items():
        chip.write(address, word)


@pytest.mark.sheet("DS-TMC4361", "11.6")
@pytest.mark.parametrize("seed", range(10))
def test_the_scale_is_the_emulated_chip_s_all_along(seed: int) -> None:
    rng = random.Random(seed)
    settings = settings_of(rng)
    bows: dict[str, Any] = {f"bow{n}": float(rng.randrange(2_000_000, 16_000_000)) for n in (1, 2, 3, 4)}
    speed = float(rng.randrange(5_000, 60_000))
    amax, dmax = (float(rng.randrange(100_000, 1_000_000)) for _ in (1, 2))
    ramp = replace(BRISK, vmax=speed, amax=amax, dmax=dmax, **bows)
    distance = rng.randrange(800, 12_000) * rng.choice((-1, 1))
    plan = position_plan(ramp, float(distance))
    found = course(settings, plan)

    chip = Chip(FeedbackOptions(), CLOCK_HZ)
    programmed(chip, settings, ramp)
    clock = math.ceil(settings.settles_s * CLOCK_HZ / TICK + 8) * TICK
    chip.advance(clock)
    chip.write(0x37, distance & 0xFFFFFFFF)
    looks = np.linspace(LATE, found.duration_s * CLOCK_HZ - LATE, 250).astype(int)
    seen = np.empty(len(looks))
    for number, after in enumerate(looks):
        chip.advance(clock + int(after))
        free = chip.feedback.plant_state.bridges == "open"
        seen[number] = -1 if free else chip.read(0x7C)

    # both ways as far as a ramp beside the plan may lead: that much earlier or later, and what a scale does meanwhile
    around = np.stack([found.at((looks + by) / CLOCK_HZ) for by in range(-LATE, LATE + 1, TICK)])
    delays = [d for d in (settings.up_delay, settings.hold_delay, settings.drive_delay) if d]
    apart = 1 + math.ceil(2 * LATE / min(delays)) if delays else 1
    wrong = (seen < around.min(axis=0) - apart) | (seen > around.max(axis=0) + apart)
    assert not wrong.any(), (looks[wrong][:4] / CLOCK_HZ, seen[wrong][:4], found.at(looks[wrong][:4] / CLOCK_HZ))
    exact = np.mean(np.abs(seen - found.at(looks / CLOCK_HZ)) <= apart)
    assert exact > 0.95


def test_a_boost_that_is_cut_short_keeps_what_it_has_reached() -> None:
    settings = CurrentSettings(
        boost=200, drive=100, hold=40, hold_en=True, drive_en=True, boost_after_start=True, boost_time=16_000,
        up_delay=320, drive_delay=160, hold_delay=1600, standby_delay=160_000,
    )  # fmt: skip
    plan = position_plan(BRISK, 4000.0)
    found = course(settings, plan)
    assert found.scale_at_first == 40
    # 1 ms at 20 us a step: 50 steps up, and down again to 90... which is below drive, so up to it
    assert found.at([0.0, 0.0005, 0.000999])[0:3].tolist() == [40, 65, 89]
    assert found.at([0.0021])[0] == 100
    said = findings(settings, plan, found)
    assert any("ends at scale 90 of 200" in text for text in said)
    end = plan.duration_s + settings.seconds(settings.standby_delay)
    assert found.at([end - 1e-6])[0] == 100
    assert found.at([end + 0.00305])[0] == 70
    assert found.at([found.duration_s])[0] == 40


def test_a_second_drive_scale_that_is_out_of_reach_is_told() -> None:
    settings = CurrentSettings(drive_2_en=True, drive_2=80, drive_2_above_pps=30_000)
    plan = velocity_plan(BRISK, 20_000.0)
    found = course(settings, plan, 1.0)
    assert any("gets to 20000 pps, VDRV_SCALE_LIMIT is 30000 pps" in text for text in findings(settings, plan, found))
    assert found.stretches[-1].situation == "drive"
    assert found.stretches[-1].end_s == 1.0


@pytest.mark.parametrize(("name", "value"), [("boost", 256), ("hold", -1), ("up_delay", 1 << 24)])
def test_what_no_register_holds_is_refused(name: str, value: int) -> None:
    with pytest.raises(ValueError, match=f"{name} is {value}, allowed is 0"):
        replace(CurrentSettings(), **cast("Any", {name: value}))


@pytest.mark.sheet("DS-TMC4361", "13.1")
@pytest.mark.parametrize("seed", range(6))
def test_the_duty_is_the_emulated_chip_s_at_every_place(seed: int) -> None:
    rng = random.Random(seed)
    pwm = PwmSettings(
        period_clocks=rng.randrange(64, 4000),
        amplitude=rng.randrange(1 << 16),
        full_at_pps=rng.choice((0, rng.randrange(1, 40_000))),
        offset=rng.randrange(1024),
        scales=rng.random() < 0.7,
    )
    velocity = float(rng.choice((0, rng.randrange(1, 50_000), -rng.randrange(1, 50_000))))
    chip = Chip(FeedbackOptions(), CLOCK_HZ)
    chip.write(0x1F, pwm.period_clocks)
    chip.write(0x05, pwm.amplitude << 16 | pwm.scales << 8)
    chip.write(0x17, pwm.full_at_pps)
    chip.write(0x79, pwm.offset)
    chip.write(0x00, chip.read(0x00) | 1 << 23)
    chip.write(0x20, 0)
    chip.write(0x24, int(velocity * 256) & 0xFFFFFFFF)
    wave = chip.feedback.fb[fl.INTEGERS_AT :].view(np.int64)[fl.WAVE : fl.WAVE + 1024].astype(float)
    a, b = pwm.duty(wave, float(pwm.amplitude_at(np.array(velocity))))
    for clock in range(1280, 40_000, 1280 if velocity else 20_000):
        chip.advance(clock)
        at = chip.read(0x79)
        fb = chip.feedback.fb
        assert (fb[fl.DUTY_A], fb[fl.DUTY_B]) == (a[at], b[at])
    state = chip.feedback.describe().pwm
    assert state is not None
    assert state.frequency_hz == pwm.frequency_hz
    assert PEAK == 248
