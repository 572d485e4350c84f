"""START wired between emulated chips: the others see an edge at the very clock at which it is put out."""

from __future__ import annotations

import itertools
import random

import pytest

from app.clock import VirtualClock
from app.emulators.core.pace import Pace
from app.emulators.tmc4361 import EmulatedTmc4361, Tmc4361Options, Tmc4361Patch
from app.emulators.wiring import EmulatorWiring, Present
from app.links.datagram40 import FETCH, Reply, read, write
from app.registers.tmc4361.table import TMC4361
from tests.emulators.tmc4361.rig import TRAPEZOID_POSITION, Ramp

XTARGET_WAITS, BY_PIN, BY_COMPARE, PIN_HIGH, AT_ONCE = 1, 1 << 5, 1 << 8, 1 << 9, 1 << 10
LISTENS = XTARGET_WAITS | BY_PIN | PIN_HIGH | AT_ONCE
LEADS = XTARGET_WAITS | BY_COMPARE | PIN_HIGH
TICK_CLOCKS = 64
RAMP = Ramp(vmax=20_000.0, vstart=1000.0)
_ADDRESSES = {row.name: row.address for row in TMC4361}


class Bench:
    """Chips that are switched on one after another, and wired at START."""

    def __init__(self, *clocks_hz: float, apart_s: float = 0.0012345, wired: bool = True) -> None:
        self.clock = VirtualClock()
        self.chips = []
        for hz in clocks_hz:
            options = Tmc4361Options.model_validate(
                {"clock_hz": hz, "wires": [{"pin": "START", "net": "start"}] if wired else []}
            )
            self.chips.append(EmulatedTmc4361(self.clock, options))
            self.clock.set(self.clock.now() + apart_s)
        self.wiring = EmulatorWiring()
        self.sync()

    def sync(self) -> None:
        self.wiring.sync([Present(f"chip{n}", chip) for n, chip in enumerate(self.chips)])

    def write(self, number: int, register: str, word: int) -> None:
        self.chips[number].exchange(write(_ADDRESSES[register], word & 0xFFFFFFFF))

    def read(self, number: int, register: str) -> int:
        self.chips[number].exchange(read(_ADDRESSES[register]))
        return Reply.decode(self.chips[number].exchange(FETCH)).data

    def wait(self, seconds: float) -> None:
        self.clock.set(self.clock.now() + seconds)

    def prepare(self, target: int, leader: int = 0) -> None:
        for number in range(len(self.chips)):
            for name, word in RAMP.words().items():
                self.write(number, name, word)
            self.write(number, "RAMPMODE", TRAPEZOID_POSITION)
            self.write(number, "CLK_FREQ", round(self.chips[number].options.clock_hz))
            self.write(number, "START_CONF", LEADS if number == leader else LISTENS)
            self.write(number, "POS_COMP", 1 << 30)
            self.write(number, "XTARGET", target)

    def first_step_s(self, number: int) -> float:
        """When the chip made its first step, on the clock of all, looked for tick by tick."""
        tick_s = TICK_CLOCKS / 16e6
        for _ in range(100_000):
            if self.chips[number].state().step_output.steps_sent:
                return self.clock.now()
            self.wait(tick_s)
        raise AssertionError("it does not move")


def starts(bench: Bench) -> list[int]:
    return [chip.state().ramp.starts for chip in bench.chips]


def ticks_of_first_step(bench: Bench, hops: int = 4000) -> list[int | None]:
    """Looked at tick by tick: in which tick each chip made its first step."""
    found: list[int | None] = [None] * len(bench.chips)
    for tick in range(hops):
        for number, chip in enumerate(bench.chips):
            if found[number] is None and chip.state().step_output.steps_sent:
                found[number] = tick
        if None not in found:
            break
        bench.wait(TICK_CLOCKS / 16e6)
    return found


def test_a_start_of_one_is_that_of_all_without_a_clock_between() -> None:
    bench = Bench(*[16e6] * 4)
    bench.prepare(3000)
    bench.wait(0.5)
    assert starts(bench) == [0, 0, 0, 0]
    bench.write(0, "POS_COMP", bench.read(0, "XACTUAL"))
    assert starts(bench) == [1, 1, 1, 1]
    for _ in range(200):  # every position at every moment is that of the others
        bench.wait(0.00123)
        positions = {bench.read(number, "XACTUAL") for number in range(4)}
        assert len(positions) == 1
    bench.wait(2.0)
    assert [bench.read(number, "XACTUAL") for number in range(4)] == [3000] * 4
    steps = {chip.state().step_output.steps_sent for chip in bench.chips}
    assert steps == {3000}


def test_the_first_steps_fall_into_one_tick() -> None:
    bench = Bench(*[16e6] * 4)
    bench.prepare(3000)
    bench.write(0, "POS_COMP", 0)
    ticks = ticks_of_first_step(bench)
    assert len(set(ticks)) == 1
    assert ticks[0] is not None


def test_unwired_chips_hear_nothing() -> None:
    bench = Bench(16e6, 16e6, wired=False)
    bench.prepare(3000)
    bench.write(0, "POS_COMP", 0)
    bench.wait(1.0)
    assert starts(bench) == [1, 0]
    assert bench.wiring.nets == ()


@pytest.mark.parametrize("asked_first", range(3))
def test_an_edge_within_a_wait_is_seen_in_its_time_whoever_is_asked(asked_first: int) -> None:
    """The leader goes off by itself, reaching a position under way: whoever is asked next finds all at that instant."""
    bench = Bench(*[16e6] * 3)
    bench.prepare(3000)
    for name, word in (
        ("START_CONF", PIN_HIGH),
        ("XTARGET", 5000),
        ("POS_COMP", 700),
        ("START_CONF", BY_COMPARE | PIN_HIGH),
    ):
        bench.write(0, name, word)
    bench.wait(3.0)
    assert bench.chips[asked_first].state().ramp.starts == 1
    assert starts(bench) == [1, 1, 1]
    assert [bench.read(number, "XACTUAL") for number in range(3)] == [5000, 3000, 3000]


def test_when_it_is_asked_makes_no_difference() -> None:
    """Asked at random moments, or once at the end: the same steps at the same clocks."""
    source = random.Random(17)
    ends = []
    for pieces in (1, 40):
        bench = Bench(*[16e6] * 3)
        bench.prepare(2500)
        for name, word in (("START_CONF", PIN_HIGH), ("XTARGET", 9000), ("POS_COMP", 1234)):
            bench.write(0, name, word)
        bench.write(0, "START_CONF", BY_COMPARE | PIN_HIGH)
        moments = [*sorted(source.uniform(0, 0.3) for _ in range(pieces - 1)), 0.3]
        for before, moment in itertools.pairwise([0.0, *moments]):
            bench.wait(moment - before)
            source.choice(bench.chips).state()
        ends.append([(chip.state().ramp.position, chip.state().step_output.steps_sent) for chip in bench.chips])
    assert ends[0] == ends[1]


def test_unequal_clocks_start_within_a_tick_and_say_that_they_round() -> None:
    bench = Bench(16e6, 12e6)
    assert [net.equal_clocks for net in bench.wiring.nets] == [False]
    bench.prepare(3000)
    bench.write(0, "POS_COMP", 0)
    assert starts(bench) == [1, 1]
    ticks = ticks_of_first_step(bench)
    assert None not in ticks
    assert abs((ticks[0] or 0) - (ticks[1] or 0)) <= 2


def test_what_the_bench_forces_on_one_start_reaches_the_others() -> None:
    bench = Bench(16e6, 16e6)
    bench.prepare(500, leader=-1)
    assert starts(bench) == [0, 0]
    bench.chips[1].patch(Tmc4361Patch.model_validate({"pins": {"start": True}}))
    bench.wait(1.0)
    assert starts(bench) == [1, 1]
    assert bench.chips[0].state().pins.start.active
    assert [chip.state().pins.start.forced for chip in bench.chips] == [None, True]
    bench.chips[1].patch(Tmc4361Patch.model_validate({"pins": {"start": "auto"}}))
    assert not bench.chips[0].state().pins.start.active


def test_one_time_scale_for_all() -> None:
    bench = Bench(16e6, 16e6)
    bench.chips[1].patch(Tmc4361Patch.model_validate({"time_scale": 2.0}))
    before = [chip.state().chip_time_s for chip in bench.chips]
    bench.wait(0.5)
    after = [chip.state().chip_time_s for chip in bench.chips]
    assert [late - early for early, late in zip(before, after, strict=True)] == pytest.approx([1.0, 1.0], abs=1e-6)


def test_cut_wires_leave_each_with_its_time_and_its_motion() -> None:
    bench = Bench(16e6, 16e6)
    bench.prepare(3000)
    bench.write(0, "POS_COMP", 0)
    bench.wait(0.05)
    gone, times = bench.chips.pop(), [chip.state().chip_time_s for chip in bench.chips]
    bench.sync()
    assert [net.open for net in bench.wiring.nets] == ["no other pin is on it"]
    assert bench.chips[0].state().chip_time_s == pytest.approx(times[0], abs=1e-6)
    bench.wait(3.0)
    assert bench.chips[0].state().ramp.position == 3000
    assert gone.state().ramp.position == 3000
    assert gone.lock is not bench.chips[0].lock


def test_work_is_bounded_for_all_together() -> None:
    """With a pace that allows nothing all stand still together, none runs ahead."""
    bench = Bench(16e6, 16e6)
    bench.prepare(1_000_000)
    bench.write(0, "POS_COMP", 0)
    pace = Pace(lambda: 0.0, share=0.0)
    pace.spend(10.0)
    for chip in bench.chips:
        chip.pace = pace
    bench.wait(50.0)
    states = [chip.state() for chip in bench.chips]
    assert all(state.time_skipped_s > 40.0 for state in states)
    assert len({state.step_output.steps_sent for state in states}) == 1
