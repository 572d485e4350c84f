"""Each axis parameter that can be set changes what the emulated module does, or its row says that it does not.

Every parameter is set to other values in short runs of the motor, and what the bench knows of it (currents, shaft,
bridges, counters, flags) has to come out differently in one of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache

import pytest

from app.emulators.tmcl.models import PLAYED
from app.registers.catalog import MODELS
from app.registers.model import Register, Space
from app.registers.tmcl.commands import Opcode
from tests.emulators.tmcl.harness import Bench

TURN_PPS = 51_200
"""A turn a second, at 256 microsteps."""
ONE_PPS, ONE_PPS2 = 16e6 / 2**20, 16e6**2 / 2**39
"""Units of a module that counts by dividers, here 4 and 6."""
SPEEDS = frozenset({4, 16, 19, 20, 22, 23, 130, 181, 182, 186, 194, 195})
RATES = frozenset({5, 15, 17, 18})
COMMANDS = frozenset({0, 1, 2, 138})
"""Parameters that are commands or counters, and no settings."""
NEVER_PPS = 7_000_000
TOLD = (1, 3, 8, 9, 10, 11, 180, 189, 190, 197, 206, 207, 208, 209, 216)
"""Parameters that tell something, as far as a module has them."""
Digest = tuple[object, ...]
Change = tuple[int, int]
"""Parameter and value."""


class Run:
    """A module with one of its parameters changed, whatever a run writes there."""

    def __init__(self, model: str, change: Change | None) -> None:
        self.rows = PLAYED[model].module.rows(Space.AXIS)
        self.by_dividers = 153 in self.rows
        self.change = change
        stage = {"left_at_fullsteps": -40, "right_at_fullsteps": 60}
        self.bench = Bench({"stage": stage}, model=model)
        self.told = [number for number in TOLD if number in self.rows]
        self.seen: list[object] = []
        self.put({153: 6, 154: 4, 140: 8, 7: 40, 6: 160, 167: 5, 5: 500_000, 4: TURN_PPS, 12: 1, 13: 1, 214: 10})
        if change is not None:
            self.bench.ask(Opcode.SAP, change[0], 0, change[1])

    def units(self, number: int, value: int) -> int:
        """A speed or an acceleration [pps, pps^2] in what this module counts."""
        if not self.by_dividers or number not in SPEEDS | RATES:
            return value
        return min(2047, round(value / (ONE_PPS if number in SPEEDS else ONE_PPS2)))

    def put(self, values: dict[int, int]) -> None:
        """Write those that the module has, but for the one that is changed."""
        for number, value in values.items():
            if number in self.rows and (self.change is None or self.change[0] != number):
                reply = self.bench.ask(Opcode.SAP, number, 0, self.units(number, value))
                # With another unit mode some numbers are none.
                assert reply.ok or self.change is not None, f"{number}: {reply.status_text}"

    def look(self, seconds: float, every: float = 0.02) -> None:
        for _ in range(round(seconds / every)):
            self.bench.run(every)
            truth = self.bench.state.truth
            self.seen.append(
                (truth.current_a_a, truth.current_b_a, truth.rotor_rad, truth.current_scale, truth.bridges)
            )
            self.seen.append(tuple(self.bench.ask(Opcode.GAP, number).value for number in self.told))

    def turn(self, turns_a_s: float) -> None:
        """By ROR, or by ROL for a negative speed."""
        speed = self.units(4, round(abs(turns_a_s) * TURN_PPS))
        self.bench.ask(Opcode.ROR if turns_a_s >= 0 else Opcode.ROL, 0, 0, speed)

    def move(self, position: int, relative: bool = False) -> None:
        self.bench.ask(Opcode.MVP, int(relative), 0, position)


def moves(run: Run) -> None:
    """There and back before it is there; from where it is then; at rest until the current is down."""
    run.put({16: 20_000, 15: 300_000, 17: 400_000, 18: 200_000, 19: 100, 20: 200, 21: 3000, 130: 300})
    run.move(30_000)
    run.look(0.4)
    run.move(-5_000)
    run.look(1.2)
    run.move(20_000)
    run.look(0.2)
    run.move(1_000, relative=True)
    run.look(2.0)


def loaded(run: Run) -> None:
    run.bench.patch(load_torque_nm=0.05)
    run.turn(2)
    run.look(0.6)
    run.turn(0)
    run.look(0.6)


def constant_off_time(run: Run) -> None:
    run.put({163: 1, 165: 2, 166: 5, 167: 3})
    run.turn(4)
    run.look(0.5)


def high_speed(run: Run) -> None:
    run.put({22: 2 * TURN_PPS, 28: 1})
    run.turn(4)
    run.look(0.8)


def high_speed_chopper(run: Run) -> None:
    run.put({22: 2 * TURN_PPS, 27: 1, 165: 2, 166: 5})
    run.turn(4)
    run.look(0.8)


def coarse_steps(run: Run) -> None:
    run.put({140: 1})
    run.move(3)
    run.look(0.5)
    run.move(40)
    run.look(0.5, 0.002)


def coolstep(run: Run) -> None:
    run.put({172: 2, 170: 2, 182: TURN_PPS // 2, 183: 60})
    run.turn(2)
    run.look(0.8)
    run.bench.patch(load_torque_nm=0.12)
    run.look(0.3)
    run.bench.patch(load_torque_nm=0.02)
    run.look(0.3)


def coolstep_to_the_bottom(run: Run) -> None:
    """With nothing to do down to the least current, then up again under a load."""
    run.put({172: 10, 170: 0, 169: 3, 174: 10 if run.by_dividers else 4, 182: TURN_PPS // 2, 6: 255})
    run.turn(2)
    run.look(1.5)
    run.bench.patch(load_torque_nm=0.15)
    run.look(0.6)


def stealthchop(run: Run) -> None:
    run.put({187: 14, 188: 120, 182: NEVER_PPS, 186: 3 * TURN_PPS})
    run.look(0.3)
    run.turn(2)
    run.look(0.6)
    run.turn(4)
    run.look(0.4)
    run.turn(0)
    run.look(0.6)


def stealthchop_by_hand(run: Run) -> None:
    run.put({187: 8, 188: 100, 192: 0, 182: NEVER_PPS, 186: NEVER_PPS})
    run.turn(1)
    run.look(0.5)


def little_current(run: Run) -> None:
    """Less than the shortest pulse of StealthChop gives."""
    run.put({} if run.by_dividers else {178: 32})
    run.put({6: 0, 7: 0, 187: 14, 188: 40, 182: NEVER_PPS, 186: NEVER_PPS})
    run.turn(0.2)
    run.look(0.6)


def freewheeling(run: Run) -> None:
    run.put({187: 14, 188: 100, 182: NEVER_PPS, 186: NEVER_PPS, 7: 0, 204: 30 if run.by_dividers else 1})
    run.turn(1)
    run.look(0.3)
    run.turn(0)
    run.look(0.6)
    run.bench.patch(load_torque_nm=0.02)
    run.look(0.6)


def dcstep(run: Run) -> None:
    run.put({23: TURN_PPS, 32: 60, 33: 4, 28: 1, 181: 1000, 182: 100})
    run.turn(4)
    run.look(0.6)
    run.bench.patch(load_torque_nm=0.2)
    run.look(0.4)
    run.bench.patch(blocked=True)
    run.look(0.3)


def stalled(run: Run) -> None:
    run.put({181: TURN_PPS // 2, 174: 3})
    run.turn(1)
    run.look(0.5)
    run.bench.patch(load_torque_nm=0.1)
    run.look(0.3)
    run.bench.patch(blocked=True)
    run.look(0.4)


def left_switch(run: Run) -> None:
    run.put({13: 0, 149: 1})
    run.turn(-1)
    run.look(0.6)
    run.turn(1)
    run.look(0.3)


def right_switch(run: Run) -> None:
    run.put({12: 0})
    run.turn(1)
    run.look(0.8)


def searches(run: Run) -> None:
    for mode in (1, 7):
        run.put({193: mode, 194: 20_000, 195: 4_000, 12: 0, 13: 0})
        run.bench.ask(Opcode.RFS, 0)
        run.look(2.5, 0.05)
        run.bench.ask(Opcode.RFS, 1)
        run.look(0.2)


def pulses(run: Run) -> None:
    run.put({254: 1})
    run.bench.patch(step_dir={"pulses": 4000, "rate_hz": 20_000})
    run.look(0.6)


def slipping(run: Run) -> None:
    run.put({217: 4000, 212: 30_000, 218: 30_000})
    run.turn(1)
    run.look(0.4)
    run.bench.patch(encoder={"slip_fullsteps": 20, "external_slip_fullsteps": 20})
    run.look(0.4)


RUNS: tuple[Callable[[Run], None], ...] = (
    *(moves, loaded, constant_off_time, high_speed, high_speed_chopper, coarse_steps, coolstep),
    *(coolstep_to_the_bottom, stealthchop),
    *(stealthchop_by_hand, little_current, freewheeling, dcstep, stalled, left_switch, right_switch, searches),
    *(pulses, slipping),
)
FIRST = {
    **dict.fromkeys((168, 171), coolstep_to_the_bottom),
    **dict.fromkeys((169, 170, 172, 182, 183), coolstep),
    **dict.fromkeys((186, 187, 188, 191, 192), stealthchop),
    **dict.fromkeys((23, 32, 33), dcstep),
    **dict.fromkeys((181, 173, 174), stalled),
    **dict.fromkeys((193, 194, 195), searches),
    **dict.fromkeys((212, 217, 218, 210), slipping),
    **dict.fromkeys((13, 14, 25, 26, 149), left_switch),
    **dict.fromkeys((12, 24), right_switch),
    **dict.fromkeys((254, 161), pulses),
    160: coarse_steps,
    163: constant_off_time,
    204: freewheeling,
    **dict.fromkeys((22, 28), high_speed),
    27: high_speed_chopper,
}
"""Where a parameter is most likely to show: to have it soon."""


def digest(model: str, how: Callable[[Run], None], change: Change | None) -> Digest:
    run = Run(model, change)
    how(run)
    return tuple(run.seen)


@cache
def usual(model: str, how: Callable[[Run], None]) -> Digest:
    return digest(model, how, None)


def settings(model: str) -> Iterator[Register]:
    """Every axis parameter that can be set and does not say that it changes nothing."""
    rows = PLAYED[model].module.rows(Space.AXIS)
    yield from (
        row for number, row in rows.items() if row.access.writable and number not in COMMANDS and not row.behaviour
    )


def values_of(row: Register) -> list[int]:
    low, high = row.minimum, row.maximum
    between = {low + (high - low) * share // 100 for share in (5, 25, 50)}
    powers = {low + (1 << n) for n in range(0, 32, 3)}
    return sorted(value for value in {low, high} | between | powers if low <= value <= high)


def acts(model: str, row: Register) -> bool:
    first = FIRST.get(row.address, moves)
    for how in (first, *(run for run in RUNS if run is not first)):
        if any(digest(model, how, (row.address, value)) != usual(model, how) for value in values_of(row)):
            return True
    return False


@pytest.mark.slow
@pytest.mark.parametrize("model", PLAYED)
def test_each_axis_parameter_changes_what_the_module_does_or_says_that_it_does_not(model: str) -> None:
    idle = [f"{row.address} {row.name}" for row in settings(model) if not acts(model, row)]
    assert idle == []


@pytest.mark.parametrize("model", PLAYED)
def test_a_run_is_the_same_each_time(model: str) -> None:
    """Else any two would differ, and every parameter would seem to act."""
    for how in RUNS:
        assert digest(model, how, None) == usual(model, how), how.__name__
    assert MODELS[model].family == "tmcl"
