"""A wrong resolution is told from steps that are lost: over random motions, motors and moments of looking."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator

import pytest

from app.calc.positions.encoder_resolution import EncoderLine, Place
from app.conditions.encoder_trace import EncoderTrace

FULL_STEP = 256
TURN = 200 * FULL_STEP
SLIP = 4 * FULL_STEP
"""What a motor loses at a time: its field is the same again four full steps further."""
STEP = 256
"""How finely a motion is played [microsteps]."""
CASES = 100

Shaft = Callable[[int, int], float]
"""The place of the shaft when the ramp has come to a position, going that way (1, -1)."""


def targets(rng: random.Random) -> list[int]:
    """There and back between two places, or about."""
    far = round(rng.uniform(0.6, 4) * TURN)
    if rng.random() < 0.5:
        return [far, 0] * 3
    return [rng.randint(-far, far) for _ in range(8)]


def motion(rng: random.Random) -> Iterator[tuple[int, int, bool]]:
    """Every position of a motion, its direction, and whether somebody looks there."""
    position, due = 0, 0
    every = rng.uniform(0.005, 0.15) * TURN
    for target in targets(rng):
        way = 1 if target > position else -1
        while (target - position) * way > 0:
            position += way * STEP
            due -= STEP
            look = due <= 0
            if look:
                due = round(every * rng.uniform(0.7, 1.3))
            yield position, way, look or (target - position) * way <= 0


def lines(rng: random.Random, shaft: Shaft, ratio: float = 1.0) -> list[EncoderLine]:
    """Every line that is found on the way, of an encoder that counts `ratio` where it should count 1."""
    trace, found = EncoderTrace(), []
    for position, way, look in motion(rng):
        turned = shaft(position, way)
        if look:
            lag = -way * rng.uniform(0, 0.3) * FULL_STEP  # the rotor behind its field, by friction
            trace.add(Place(position, ratio * (turned + lag) - position), TURN)
            line = trace.line(FULL_STEP, TURN)
            if line is not None:
                found.append(line)
    return found


def followed(position: int, way: int) -> float:
    return position


def test_a_wrong_resolution_is_found_and_a_right_one_never() -> None:
    told = 0
    for seed in range(CASES):
        assert not lines(random.Random(seed), followed)
        rng = random.Random(seed)
        ratio = rng.choice([-1, 1]) * rng.choice([rng.uniform(0.1, 0.9), rng.uniform(1.1, 8)])
        found = lines(random.Random(seed), followed, ratio)
        assert all(1 + line.slope == pytest.approx(ratio, abs=0.02 * max(1, abs(ratio))) for line in found)
        told += bool(found)
    assert told > CASES / 2


def test_a_wrong_resolution_is_found_by_there_and_back_twice() -> None:
    for ratio in (0.5, 0.8, 0.95, 1.05, 1.25, 2.0, -1.0, 10.0):
        trace = EncoderTrace()
        for target, start in ((2, 0), (0, 2), (2, 0), (0, 2)):
            for step in range(11):
                position = round((start + (target - start) * step / 10) * TURN)
                trace.add(Place(position, (ratio - 1) * position), TURN)
        line = trace.line(FULL_STEP, TURN)
        assert line is not None, ratio
        assert line.slope == pytest.approx(ratio - 1)


class Lossy:
    """A motor that does not follow while `stalls` says so; what it loses it loses for good, by four full steps."""

    def __init__(self, stalls: Callable[[int, int], bool]) -> None:
        self._stalls = stalls
        self._shaft = 0.0
        self._at = 0

    def __call__(self, position: int, way: int) -> float:
        if not self._stalls(position, way):
            # It catches the field again at the nearest place where that pulls it.
            behind = (position - self._shaft) % SLIP
            self._shaft += behind if behind <= SLIP / 2 else behind - SLIP
        return self._shaft


def blocked_from(rng: random.Random) -> Callable[[int, int], bool]:
    """Blocked from some moment on, for good or for a while."""
    passed, begins = 0, rng.uniform(0, 4) * TURN / STEP
    lasts = rng.choice([rng.uniform(0.05, 2) * TURN / STEP, float("inf")])

    def stalls(position: int, way: int) -> bool:
        nonlocal passed
        passed += 1
        return begins <= passed < begins + lasts

    return stalls


def hard_stop(rng: random.Random) -> Callable[[int, int], bool]:
    """The same stretch of the way is too hard for it, in one direction or both."""
    a, b = sorted(rng.uniform(-3, 3) * TURN for _ in range(2))
    ways = rng.choice([(1,), (-1,), (1, -1)])
    return lambda position, way: a <= position <= b and way in ways


def loses_now_and_then(rng: random.Random) -> Callable[[int, int], bool]:
    """It loses steps by chance, here and there."""
    share, left = rng.uniform(0.0005, 0.02), 0

    def stalls(position: int, way: int) -> bool:
        nonlocal left
        left = rng.randint(8, 64) if left <= 0 and rng.random() < share else left - 1
        return left > 0

    return stalls


def loses_at_an_even_rate(rng: random.Random) -> Callable[[int, int], bool]:
    """It falls behind by four full steps each time that it has gone so far, in one direction or both."""
    period, ways = rng.randint(2, 60) * SLIP, rng.choice([(1,), (-1,), (1, -1)])
    passed = 0

    def stalls(position: int, way: int) -> bool:
        nonlocal passed
        passed += STEP
        return way in ways and passed % period < SLIP

    return stalls


@pytest.mark.parametrize("fault", [blocked_from, hard_stop, loses_now_and_then, loses_at_an_even_rate])
def test_steps_that_are_lost_are_never_a_wrong_resolution(
    fault: Callable[[random.Random], Callable[[int, int], bool]],
) -> None:
    for seed in range(CASES):
        assert not lines(random.Random(seed), Lossy(fault(random.Random(seed + 1)))), seed


def test_a_shaft_that_never_turns_is_no_wrong_resolution() -> None:
    for seed in range(CASES):
        assert not lines(random.Random(seed), lambda position, way: 0.0)


def test_two_places_alone_say_nothing_of_what_is_between() -> None:
    trace = EncoderTrace()
    for _ in range(20):
        trace.add(Place(0, 0.0), TURN)
        trace.add(Place(2 * TURN, 5000.0), TURN)
    assert trace.line(FULL_STEP, TURN) is None


def test_a_line_that_its_places_hardly_keep_to_is_none() -> None:
    """A play of 100 microsteps each way against a slope that makes 700 of a turn."""
    for play, found in ((100, False), (10, True)):
        trace = EncoderTrace()
        for target, start in ((1, 0), (0, 1), (1, 0)):
            for step in range(21):
                position = round((start + (target - start) * step / 20) * TURN)
                trace.add(Place(position, position * 700 / TURN + play * (start - target)), TURN)
        assert (trace.line(FULL_STEP, TURN) is not None) is found
