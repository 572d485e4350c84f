"""Microstep resolution: where in the wave of 1024 entries a motor stands at each setting of MRES.

DS-TMC5130A 1.14, 17.2: a step is 2^MRES entries wide and the first one lies half a step from 0, so that full steps are
at 128, 384, 640 and 896 with both coils alike; another resolution takes the nearest of its own steps. Dumps of real
parts show the same. The oracle counts the allowed places, and works currents out from the sine.
"""

from __future__ import annotations

import math

import pytest

from app.emulators.tmc5xxx import Tmc5xxxModel
from app.emulators.tmc5xxx.chips import CHIPS
from tests.emulators.tmc5xxx.rig import CHOPPER_ON, PLACES, TURN, Bench, moving

WITH_MRES = [(model, axis) for model, axis in PLACES if model != "tmc5031"]
INTPOL = 1 << 28
FIRST = {8: 128, 7: 64, 6: 32}
"""What the sheet says of full, half and quarter steps."""


def places(mres: int) -> list[int]:
    width = 1 << mres
    return [place for place in range(1024) if place % width == width // 2]


def current(place: int) -> int:
    """The default wave, whose negative half is the complement of the positive one."""
    value = math.floor(248 * math.sin((2 * math.pi * (place % 512) + math.pi) / 1024) + 0.5) - 1
    return value if place % 1024 < 512 else -1 - value


def seen(bench: Bench, axis: int) -> tuple[int, int, int]:
    sine, cosine = (bench.field("MSCURACT", f"CUR_{phase}", axis) for phase in "BA")
    return bench.read("MSCNT", axis), sine, cosine


def assert_stands_at(bench: Bench, axis: int, place: int) -> None:
    assert seen(bench, axis) == (place, current(place), current(place + 256))
    assert bench.state().axes[axis].truth.rotor_fullsteps * 256 % 1024 == pytest.approx(place)


def resolved(bench: Bench, axis: int, mres: int, extra: int = 0) -> None:
    bench.put(axis, CHOPCONF=CHOPPER_ON | mres << 24 | extra)
    bench.wait(1e-3)


def test_the_oracle_itself() -> None:
    assert {mres: places(mres)[0] for mres in FIRST} == FIRST
    assert places(8) == [128, 384, 640, 896]
    assert places(4)[:3] == [8, 24, 40]
    assert places(0) == list(range(1024))
    # dumps of real parts: MSCNT, and both currents
    for place, sine, cosine in ((8, 12, 247), (30, 45, 243), (584, -107, -224)):
        assert (current(place), current(place + 256)) == (sine, cosine)


@pytest.mark.parametrize("interpolated", [0, INTPOL])
def test_a_tmc5160_with_16_microsteps_is_as_a_dump_of_a_real_one(interpolated: int) -> None:
    bench = moving("tmc5160")
    bench.patch(power_cycle=True)
    resolved(bench, 0, 4, interpolated)
    assert bench.read("MSCNT") == 8
    assert bench.raw("MSCURACT") == 0x00F7_000C


@pytest.mark.parametrize("mres", range(9))
@pytest.mark.parametrize(("model", "axis"), WITH_MRES)
def test_every_step_is_a_place_of_the_resolution(model: Tmc5xxxModel, axis: int, mres: int) -> None:
    allowed = places(mres)
    for interpolated in {0, INTPOL if mres in CHIPS[model].interpolates else 0}:
        bench = moving(model, axis)
        resolved(bench, axis, mres, interpolated)
        for position in (0, 1, 2, 3, 7, 4 * (256 >> mres) + 1, 1, 0, -1, -2, -5):
            bench.put(axis, XTARGET=position)
            bench.wait(0.5)
            assert bench.read("XACTUAL", axis) == position
            assert_stands_at(bench, axis, allowed[position % len(allowed)])


@pytest.mark.parametrize(("model", "axis"), WITH_MRES)
def test_both_coils_are_alike_at_full_steps(model: Tmc5xxxModel, axis: int) -> None:
    bench = moving(model, axis)
    resolved(bench, axis, 8)
    for position, place in enumerate((128, 384, 640, 896)):
        bench.put(axis, XTARGET=position)
        bench.wait(0.5)
        counter, sine, cosine = seen(bench, axis)
        assert counter == place
        assert {abs(sine), abs(cosine)} <= {174, 175, 176}


@pytest.mark.parametrize("to", range(9))
@pytest.mark.parametrize("from_", range(9))
def test_a_change_of_resolution_takes_the_nearest_step(from_: int, to: int) -> None:
    """Of two that are equally near the upper one: 0 becomes 8 at 16 microsteps, as dumps show. The other way round
    nothing is known, and it is taken to be the same. A finer resolution whose steps include the place leaves it."""
    for position in (0, 1, 5, 100, 683, -1):
        bench = moving("tmc5130")
        resolved(bench, 0, from_)
        bench.put(XTARGET=position)
        bench.wait(3)
        before = bench.read("MSCNT")
        resolved(bench, 0, to)
        away = [(abs((place - before + 512) % 1024 - 512), place) for place in places(to)]
        nearest = {place for distance, place in away if distance == min(away)[0]}
        upper = max(nearest, key=lambda place: (place - before) % 1024 < 512)
        assert_stands_at(bench, 0, upper)
        bench.put(XTARGET=position + 1)
        bench.wait(0.5)
        assert_stands_at(bench, 0, (upper + (1 << to)) % 1024)


@pytest.mark.parametrize("mres", [1, 4, 8])
def test_shaft_mirrors_the_steps(mres: int) -> None:
    bench = moving("tmc5130")
    resolved(bench, 0, mres)
    bench.write("GCONF", 1 << 4)
    allowed = places(mres)
    for position in (1, 2, 5, -3):
        bench.put(XTARGET=position)
        bench.wait(0.5)
        assert_stands_at(bench, 0, allowed[-position % len(allowed)])


@pytest.mark.parametrize("mres", range(9))
def test_a_motor_with_physics_is_held_there(mres: int) -> None:
    bench = moving("tmc5160", rigid=False)
    resolved(bench, 0, mres)
    bench.put(XTARGET=3)
    bench.wait(1)
    truth = bench.state().axes[0].truth
    place = places(mres)[3 % len(places(mres))] if mres < 8 else 896
    assert truth.field_fullsteps * 256 == pytest.approx(place + 0.5)
    # the detent torque pulls it off by up to 8 microsteps
    assert truth.rotor_fullsteps * 256 == pytest.approx(place, abs=10)
    assert truth.lost_fullsteps == 0


@pytest.mark.parametrize("mres", [1, 4, 8])
@pytest.mark.parametrize("model", ["tmc5062", "tmc5072", "tmc5130", "tmc5160"])
def test_the_encoder_goes_with_the_shaft(model: Tmc5xxxModel, mres: int) -> None:
    """It starts where the shaft was before: the half step to the first place is the encoder's to show."""
    bench = moving(model)
    microsteps = TURN >> mres
    bench.put(ENC_CONST=round(microsteps / 40_000 * 65_536))
    resolved(bench, 0, mres)
    bench.put(XTARGET=microsteps)
    bench.wait(30 if mres < 8 else 5)
    assert bench.read("XACTUAL") == microsteps
    assert bench.read("X_ENC") == pytest.approx(microsteps + 0.5, abs=1.0)
