"""Reference search: all modes on a stage, from every place, with swapped sides and inverted home."""

from __future__ import annotations

from abc import ABC, abstractmethod

import pytest

from app.emulators.tmcl import search
from app.registers.tmcl.commands import Opcode, reference_modes
from tests.emulators.tmcl.harness import FULLSTEP, Bench

pytestmark = pytest.mark.sheet("FM-PD42-1241", "7.1")

LEFT_AT, RIGHT_AT, HOME_FROM, HOME_TO = -60.0, 80.0, -30.0, -14.0
MIDDLE = (HOME_FROM + HOME_TO) / 2
STICKY = 8.0
"""Of a left stop switch with hysteresis [full steps]."""
WITHIN = 1.0
"""Detent and load angle keep the rotor within this of its field [full steps]."""


def stage(start: float) -> Bench:
    bench = Bench(
        {
            "stage": {
                "left_at_fullsteps": LEFT_AT,
                "right_at_fullsteps": RIGHT_AT,
                "home_from_fullsteps": HOME_FROM,
                "home_to_fullsteps": HOME_TO,
            },
            "start_fullsteps": start,
        }
    )
    for number, value in {194: 20_000, 195: 3000, 5: 400_000, 17: 400_000}.items():
        bench.sap(number, value)
    return bench


def searched(mode: int, start: float = 0.0, limit_s: float = 30.0) -> Bench:
    """A bench after a whole search; the motor stands."""
    bench = stage(start)
    bench.sap(193, mode)
    if mode >= 128:  # the inverted input is active everywhere but here
        bench.patch(stage={"home_from_fullsteps": HOME_FROM, "home_to_fullsteps": HOME_TO})
        bench = _inverted(bench)
    assert bench.do(Opcode.RFS, 2) == 0
    bench.do(Opcode.RFS, 0)
    assert bench.do(Opcode.RFS, 2) != 0
    assert bench.state.search.phase
    bench.until(lambda: bench.do(Opcode.RFS, 2) == 0, limit_s)
    assert bench.state.search.phase == ""
    assert bench.gap(3) == 0
    bench.run(0.3)
    return bench


def _inverted(bench: Bench) -> Bench:
    """A home switch that is open only between its edges: forced by hand, as the stage has none."""
    return _InvertedHome(bench)


class _Following(Bench, ABC):
    """Follows the stage in small steps of time and presses switches as it likes."""

    def __init__(self, bench: Bench) -> None:
        self.clock, self.module, self.address = bench.clock, bench.module, bench.address
        self._press()

    @abstractmethod
    def _press(self) -> None: ...

    def run(self, seconds: float) -> None:
        end_s = self.clock.now() + seconds
        while self.clock.now() < end_s - 1e-9:
            super().run(min(0.0005, end_s - self.clock.now()))
            self._press()


class _InvertedHome(_Following):
    """A home switch that is pressed everywhere but between its edges."""

    def _press(self) -> None:
        place = self.state.truth.rotor_fullsteps
        self.patch(switches={"home": not HOME_FROM <= place <= HOME_TO})


class _StickyLeft(_Following):
    """A left stop switch that opens only `STICKY` away from where it closes."""

    closed = False

    def _press(self) -> None:
        place = self.state.truth.rotor_fullsteps
        self.closed = place <= (LEFT_AT + STICKY if self.closed else LEFT_AT)
        self.patch(switches={"left": self.closed})


def _zero_at(bench: Bench) -> float:
    """Where the counter's zero is on the stage [full steps]."""
    return bench.state.truth.rotor_fullsteps - bench.gap(1) / FULLSTEP


STARTS = [0.0, LEFT_AT - 5, RIGHT_AT + 5]


@pytest.mark.sheet("FM-PD42-1241", "7.1.1")
@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize(("mode", "where"), [(1, LEFT_AT), (65, RIGHT_AT)])
def test_mode_1_finds_one_stop_switch(mode: int, where: float, start: float) -> None:
    bench = searched(mode, start)
    assert _zero_at(bench) == pytest.approx(where, abs=WITHIN)
    assert abs(bench.gap(1)) < 20
    assert bench.gap(0) == bench.gap(1)
    assert bench.gap(197) == pytest.approx((where - start) * FULLSTEP, abs=2 * FULLSTEP)
    assert bench.gap(196) == 0


@pytest.mark.sheet("FM-PD42-1241", "7.1.2")
@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize(("mode", "where"), [(2, LEFT_AT), (66, RIGHT_AT)])
def test_mode_2_measures_the_stage(mode: int, where: float, start: float) -> None:
    bench = searched(mode, start)
    assert _zero_at(bench) == pytest.approx(where, abs=WITHIN)
    if start == 0.0:
        assert bench.gap(196) == pytest.approx((RIGHT_AT - LEFT_AT) * FULLSTEP, abs=2 * FULLSTEP)


@pytest.mark.sheet("FM-PD42-1241", "7.1.3")
@pytest.mark.parametrize(("mode", "where"), [(3, LEFT_AT), (67, RIGHT_AT)])
def test_mode_3_measures_to_the_middle(mode: int, where: float) -> None:
    # FM-PD42-1241 means the middle of the switch. One that has an end of the stage behind it has two places where it
    # can be found: where it opens when left, and where it closes when entered.
    bench = searched(mode)
    assert _zero_at(bench) == pytest.approx(where, abs=WITHIN)
    assert bench.gap(196) == pytest.approx((RIGHT_AT - LEFT_AT) * FULLSTEP, abs=2 * FULLSTEP)


@pytest.mark.sheet("FM-PD42-1241", "7.1.4")
@pytest.mark.parametrize(("mode", "where"), [(4, LEFT_AT), (68, RIGHT_AT)])
def test_mode_4_finds_the_middle_of_one_switch(mode: int, where: float) -> None:
    bench = searched(mode)
    assert _zero_at(bench) == pytest.approx(where, abs=WITHIN)
    assert bench.gap(196) == 0


@pytest.mark.parametrize(
    ("mode", "where"),
    [
        pytest.param(1, LEFT_AT, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.1")),
        pytest.param(2, LEFT_AT, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.2")),
        pytest.param(3, LEFT_AT + STICKY / 2, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.3")),
        pytest.param(4, LEFT_AT + STICKY / 2, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.4")),
    ],
)
def test_only_modes_3_and_4_take_the_middle_of_two_switching_points(mode: int, where: float) -> None:
    bench = _StickyLeft(stage(-40.0))
    bench.sap(193, mode)
    bench.do(Opcode.RFS, 0)
    bench.until(lambda: bench.do(Opcode.RFS, 2) == 0)
    bench.run(0.3)
    assert _zero_at(bench) == pytest.approx(where, abs=WITHIN)
    measured = (RIGHT_AT - where) * FULLSTEP if mode in (2, 3) else 0
    assert bench.gap(196) == pytest.approx(measured, abs=2 * FULLSTEP)


@pytest.mark.parametrize(
    ("mode", "start", "first"),
    [
        pytest.param(5, -50.0, -1, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.5")),
        pytest.param(6, 40.0, 1, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.6")),
    ],
)
def test_modes_5_and_6_go_their_own_way_first_and_turn_at_the_stop_switch(mode: int, start: float, first: int) -> None:
    bench = stage(start)
    bench.sap(193, mode)
    bench.do(Opcode.RFS, 0)
    bench.run(0.1)
    assert bench.gap(3) * first > 0
    bench.until(lambda: bench.gap(11 if first < 0 else 10) == 1, step_s=0.001)
    bench.until(lambda: bench.gap(3) * first < 0, step_s=0.001)


HOME_STARTS = [0.0, -50.0, MIDDLE, LEFT_AT - 5, RIGHT_AT + 5]


@pytest.mark.parametrize("start", HOME_STARTS)
@pytest.mark.parametrize(
    "mode",
    [
        pytest.param(5, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.5")),
        pytest.param(6, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.6")),
    ],
)
def test_modes_5_and_6_find_the_middle_of_home_from_anywhere(mode: int, start: float) -> None:
    bench = searched(mode, start)
    assert _zero_at(bench) == pytest.approx(MIDDLE, abs=0.6)
    assert abs(bench.gap(1)) <= 1
    assert bench.gap(197) == pytest.approx((MIDDLE - start) * FULLSTEP, abs=2.5 * FULLSTEP)


@pytest.mark.parametrize(
    ("mode", "start", "first"),
    [
        pytest.param(7, -60.0, 1, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.7")),
        pytest.param(8, 0.0, -1, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.8")),
    ],
)
def test_modes_7_and_8_ignore_the_stop_switches(mode: int, start: float, first: int) -> None:
    # FM-PD42-1241 says "positive" for both. The constant says which way each of them goes here.
    assert search.DIRECTION_7_AND_8[mode - 7] == first
    bench = stage(start)
    bench.patch(switches={"left": True, "right": True})
    bench.sap(193, mode)
    bench.do(Opcode.RFS, 0)
    bench.run(0.2)
    assert bench.gap(3) * first > 0
    bench.until(lambda: bench.do(Opcode.RFS, 2) == 0)
    bench.run(0.3)
    assert _zero_at(bench) == pytest.approx(MIDDLE, abs=0.6)
    bench.run(0.01)
    bench.do(Opcode.ROR, 0, 0, 5000)
    bench.run(0.5)
    assert bench.gap(3) == 0  # afterwards they stop the motor again


@pytest.mark.parametrize(
    ("mode", "start"),
    [
        pytest.param(133, 0.0, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.5")),
        pytest.param(134, -50.0, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.6")),
        pytest.param(135, -50.0, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.7")),
        pytest.param(136, 0.0, marks=pytest.mark.sheet("FM-PD42-1241", "7.1.8")),
    ],
)
def test_128_inverts_the_home_switch(mode: int, start: float) -> None:
    bench = searched(mode, start)
    assert _zero_at(bench) == pytest.approx(MIDDLE, abs=0.6)


def test_every_mode_is_tested_here() -> None:
    assert set(reference_modes()) == {1, 2, 3, 4, 5, 6, 7, 8, 65, 66, 67, 68, 133, 134, 135, 136}


@pytest.mark.parametrize("mode", [1, 5])
def test_disabled_stop_switches_do_not_matter(mode: int) -> None:
    bench = stage(-50.0)
    bench.sap(12, 1)
    bench.sap(13, 1)
    bench.sap(193, mode)
    bench.do(Opcode.RFS, 0)
    bench.until(lambda: bench.do(Opcode.RFS, 2) == 0)
    bench.run(0.3)
    assert _zero_at(bench) == pytest.approx(LEFT_AT if mode == 1 else MIDDLE, abs=WITHIN)


def test_speeds_are_those_of_parameters_194_and_195() -> None:
    bench = stage(40.0)
    bench.sap(193, 5)
    bench.do(Opcode.RFS, 0)
    bench.run(0.3)
    assert bench.gap(3) == -20_000
    bench.until(lambda: bench.gap(9) == 1, step_s=0.001)
    bench.run(0.2)
    assert bench.gap(3) == 3000


def test_a_soft_stop_does_not_shift_the_zero() -> None:
    bench = stage(0.0)
    bench.sap(26, 1)
    bench.sap(17, 20_000)
    bench.sap(193, 1)
    bench.do(Opcode.RFS, 0)
    bench.until(lambda: bench.do(Opcode.RFS, 2) == 0)
    bench.run(0.3)
    assert _zero_at(bench) == pytest.approx(LEFT_AT, abs=WITHIN)
    assert bench.gap(1) < -50  # it came to rest behind the switch


def test_encoders_are_zero_with_the_counter() -> None:
    # Open on this module; the sister's does so, and the deviation would be wrong otherwise.
    bench = stage(0.0)
    bench.sap(212, 3000)
    bench.sap(218, 3000)
    bench.sap(193, 5)
    bench.do(Opcode.RFS, 0)
    bench.until(lambda: bench.do(Opcode.RFS, 2) == 0)
    bench.run(0.3)
    assert bench.gap(209) == pytest.approx(0, abs=150)
    assert bench.gap(216) == pytest.approx(0, abs=150)
    assert bench.gap(207) == 0


@pytest.mark.sheet("FM-PD42-1241", "3.6.11")
def test_a_search_can_be_stopped() -> None:
    bench = stage(0.0)
    bench.sap(193, 5)
    bench.do(Opcode.RFS, 0)
    bench.run(0.2)
    bench.do(Opcode.RFS, 1)
    assert bench.do(Opcode.RFS, 2) == 0
    bench.stand()
    bench.do(Opcode.RFS, 1)  # nothing to stop is no error
    assert bench.ask(Opcode.RFS, 3).status == 3
    assert bench.gap(197) == 0


@pytest.mark.parametrize("command", [(Opcode.MST, 0, 0), (Opcode.ROR, 0, 1000), (Opcode.MVP, 0, 500)])
def test_another_motion_command_ends_it(command: tuple[int, int, int]) -> None:
    opcode, type_, value = command
    bench = stage(0.0)
    bench.do(Opcode.RFS, 0)
    bench.run(0.1)
    bench.do(opcode, type_, 0, value)
    assert bench.do(Opcode.RFS, 2) == 0
    bench.run(2.0)
    assert bench.gap(3) == (1000 if opcode == Opcode.ROR else 0)


def test_a_deviation_ends_it() -> None:
    bench = stage(0.0)
    bench.sap(212, 2000)
    bench.do(Opcode.RFS, 0)
    bench.run(0.1)
    bench.patch(blocked=True)
    bench.run(0.5)
    assert bench.do(Opcode.RFS, 2) == 0
    assert bench.gap(207) == 2


def test_without_a_home_switch_it_waits_at_the_other_end() -> None:
    # Open: what a search does that finds nothing. Here it stands until somebody stops it.
    bench = stage(0.0)
    bench.patch(switches={"home": False})
    bench.sap(193, 5)
    bench.do(Opcode.RFS, 0)
    bench.until(lambda: bench.gap(10) == 1)
    bench.run(2.0)
    assert bench.do(Opcode.RFS, 2) != 0
    assert bench.gap(3) == 0
    bench.do(Opcode.RFS, 1)
    assert bench.do(Opcode.RFS, 2) == 0


def test_an_overrun_home_switch_is_found_all_the_same() -> None:
    bench = stage(40.0)
    bench.sap(5, 20_000)  # too slow to stop inside
    bench.sap(193, 8)
    bench.do(Opcode.RFS, 0)
    bench.until(lambda: bench.do(Opcode.RFS, 2) == 0)
    bench.run(0.3)
    assert _zero_at(bench) == pytest.approx(MIDDLE, abs=0.6)
