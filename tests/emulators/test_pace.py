"""A bound for the work of a catch-up: what cannot be worked out in time is left out, and told."""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence

import pytest

from app.clock import VirtualClock
from app.emulators.build import build_emulator, options_of
from app.emulators.core.family import Emulator
from app.emulators.core.pace import AT_ONCE_S, IN_STORE_S, Pace
from app.emulators.families import FAMILIES
from app.links import datagram32, datagram40
from app.links.datagram_uart import UartForm
from app.links.emulator import EmulatorPort
from app.links.tmcl import Reply, Request
from app.registers.listed.package import listings

NIGHT_S = 8 * 3600.0
WITHIN_S = 0.06
"""Far less than a stop may take [s of processor time]."""
STIFF: dict[str, object] = {"motor": {"rotor_inertia_kgm2": 1e-7}, "load": {"inertia_kgm2": 0.0}}
TURNING = {
    # every pulse a step, with multiplexed switches: all that three axes can ask for
    "tmc428": [
        datagram32.write(0x3F, 0x10_0010),
        *(
            datagram32.write(axis << 4 | register, word)
            for axis in range(3)
            for register, word in ((0x3, 2047), (0x6, 2047), (0xC, 6), (0xA, 2), (0x4, 2047))
        ),
    ],
    "tmc5160": [
        datagram40.write(address, word)
        for address, word in (
            *((0x6C, 0x1041_0155), (0x10, 0x1F0F)),
            *((0x26, 2000), (0x24, 2000), (0x27, 90_000), (0x20, 1)),
        )
    ],
    "tmc4361": [
        datagram40.write(address, word)
        for address, word in ((0x28, 80_000), (0x29, 80_000), (0x20, 1), (0x24, 5000 << 8))
    ],
    "tmc2209": [
        UartForm().write(address, word)
        for address, word in ((0x00, 0x1C4), (0x10, 0x1F0F), (0x6C, 0x1000_0053), (0x22, 71_583))
    ],
    "pd42-1241": [Request(1, 4, 4, 0, 1000).encode(), Request(1, 1, 0, 0, 500).encode()],
}


def bench(model: str, options: dict[str, object] | None = None) -> tuple[VirtualClock, Emulator]:
    clock = VirtualClock()
    emulator = build_emulator(model, clock, options_of(model).model_validate(options or {}))
    emulator.catch_up(0.0)
    clock.set(0.001)
    emulator.catch_up(1.0)  # compiled
    emulator.pace = Pace(clock.now)
    return clock, emulator


def turn(emulator: Emulator, frames: Sequence[bytes]) -> None:
    for frame in frames:
        emulator.exchange(frame)


def worked(emulator: Emulator) -> float:
    """How long somebody waits who asks now [s of processor time]."""
    began_s = time.thread_time()
    emulator.state()
    return time.thread_time() - began_s


@pytest.mark.parametrize("model", TURNING)
@pytest.mark.parametrize("scale", [1, 1000])
def test_a_night_of_motion_holds_nobody_up(model: str, scale: int, caplog: pytest.LogCaptureFixture) -> None:
    clock, emulator = bench(model, STIFF if model in ("tmc5160", "tmc2209") else {})
    turn(emulator, TURNING[model])
    emulator.clock.scale = scale
    clock.set(clock.now() + NIGHT_S)
    with caplog.at_level(logging.WARNING):
        assert worked(emulator) < WITHIN_S
    skipped_s = emulator.clock.skipped_s
    assert skipped_s > 0.9 * scale * NIGHT_S
    told = emulator.state().model_dump()
    assert told["time_skipped_s"] == skipped_s
    assert told["chip_time_s"] + skipped_s == pytest.approx(scale * NIGHT_S, rel=1e-6)
    assert f"emulated {model} stood still for" in caplog.text


@pytest.mark.parametrize("model", TURNING)
def test_at_rest_a_night_passes_at_once_and_nothing_is_left_out(model: str) -> None:
    clock, emulator = bench(model)
    clock.set(5.0)
    while not emulator.catch_up(0.05):
        pass
    clock.set(NIGHT_S)
    assert worked(emulator) < 0.01
    assert emulator.clock.skipped_s == 0.0
    assert emulator.state().model_dump()["chip_time_s"] == NIGHT_S


def test_what_is_skipped_is_time_and_not_motion() -> None:
    """It goes on where it was, as one that nobody skipped."""
    clock, emulator = bench("tmc5160")
    other_clock, other = bench("tmc5160")
    other.pace = None
    for each in (emulator, other):
        turn(each, TURNING["tmc5160"])
    clock.set(NIGHT_S)
    at_s = emulator.state().model_dump()["chip_time_s"]
    other_clock.set(at_s)
    assert emulator.state().model_dump()["axes"] == other.state().model_dump()["axes"]
    clock.set(NIGHT_S + 0.25)
    other_clock.set(at_s + 0.25)
    skipped_s = emulator.clock.skipped_s
    assert emulator.state().model_dump()["axes"] == other.state().model_dump()["axes"]
    assert emulator.clock.skipped_s == skipped_s


def test_emulators_share_what_they_may_work() -> None:
    """Asked without pause at the fastest time scale, they leave half of the time to others."""
    clock = VirtualClock()
    pace = Pace(clock.now)
    chips = [build_emulator("tmc5160", clock, options_of("tmc5160").model_validate(STIFF)) for _ in range(3)]
    for chip in chips:
        chip.catch_up(0.0)
        turn(chip, TURNING["tmc5160"])
        chip.clock.scale, chip.pace = 1000, pace
    began_s, asked = time.thread_time(), 40
    for _ in range(asked):
        clock.set(clock.now() + 0.01)
        for chip in chips:
            chip.state()
    assert time.thread_time() - began_s < IN_STORE_S + 0.5 * 0.01 * asked + 3 * 0.05
    assert all(chip.clock.skipped_s > 0 for chip in chips)


def test_a_store_that_was_spent_fills_with_half_of_the_time() -> None:
    clock = VirtualClock(10.0)
    pace = Pace(clock.now)
    assert pace.allowed_s() == AT_ONCE_S
    pace.spend(IN_STORE_S)
    assert pace.allowed_s() <= 0.0
    clock.set(10.02)
    assert pace.allowed_s() == pytest.approx(0.01)


def test_one_piece_that_took_long_is_not_paid_for_without_end() -> None:
    clock = VirtualClock(10.0)
    pace = Pace(clock.now)
    pace.spend(60.0)
    assert pace.allowed_s() <= -AT_ONCE_S
    clock.set(10.0 + 2 * IN_STORE_S + 2 * AT_ONCE_S)
    assert pace.allowed_s() == pytest.approx(AT_ONCE_S)


def test_samples_of_skipped_time_are_missed_and_counted() -> None:
    clock, emulator = bench("tmc5160", STIFF)
    turn(emulator, TURNING["tmc5160"])
    emulator.clock.scale = 1000
    port = EmulatorPort(emulator, hurries=True)
    taken: list[float] = []
    port.start_sampling([datagram40.read(0x21)], 0.1, lambda at_s, _: taken.append(at_s))
    clock.set(clock.now() + 5.0)
    began_s = time.thread_time()
    port.run_due_samples()
    assert time.thread_time() - began_s < WITHIN_S
    assert port.samples_missed > 0
    assert len(taken) + port.samples_missed == 51
    assert taken == sorted(set(taken))
    assert emulator.clock.now() == pytest.approx(emulator.state().model_dump()["chip_time_s"])


def test_every_family_is_held_to_it() -> None:
    assert all(set(family.models) & set(TURNING) for family in FAMILIES if family.models)


def test_a_listed_module_works_a_night_out_as_one_step() -> None:
    """Its axes are worked out by phases, not by ticks: nothing has to be left out."""
    model = next(iter(listings()))
    clock, emulator = bench(model, {"time_scale": 20})
    emulator.exchange(Request(1, 1, 0, 0, 500).encode())
    clock.set(clock.now() + NIGHT_S)
    assert worked(emulator) < WITHIN_S
    assert emulator.clock.skipped_s == 0.0
    turned = Reply.decode(emulator.exchange(Request(1, 6, 1, 0, 0).encode())).value
    assert turned != 0


@pytest.mark.parametrize("model", TURNING)
async def test_no_answer_is_of_a_time_that_was_skipped(model: str) -> None:
    """Whoever asks after a night believes it to be of the chip's time then, and not of hours to come."""
    clock, emulator = bench(model, STIFF if model in ("tmc5160", "tmc2209") else {})
    port = EmulatorPort(emulator, hurries=True)
    turn(emulator, TURNING[model])
    clock.set(NIGHT_S)
    await port.exchange(TURNING[model][0])
    assert emulator.clock.skipped_s > 0.9 * NIGHT_S
    assert port.last_exchange_s == port.device_time_s() == emulator.clock.at(clock.now())
