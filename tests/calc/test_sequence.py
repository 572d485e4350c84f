"""Sequences of a TMC4361 against the emulated chip, which shares no code with the calculator, and what cannot be."""

from __future__ import annotations

import random
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest

from app.calc.tmc4361.sequence import RAMPMODES, SETS, Motion, RampSet, Sequence, Shadow, Shape, motion
from tests.emulators.tmc4361.moves import random_ramp
from tests.emulators.tmc4361.rig import TICK_S, Ramp, Rig

BASE = RampSet({"vmax": 20_000, "amax": 100_000, "dmax": 100_000, **{f"bow{n}": 1e6 for n in (1, 2, 3, 4)}})
PULSE_S = 1e-4
BY_TARGET, PIPE = 1 << 6, 1 << 12


def ramp_set(source: random.Random, shape: Shape, on_the_fly: bool, names: tuple[str, ...] | None = None) -> RampSet:
    ramp = random_ramp(source, RAMPMODES[shape])
    ramp = replace(ramp, vmax=min(ramp.vmax, 50_000.0), vstart=0.0, vbreak=0.0)
    if shape == "s":
        ramp = replace(ramp, vstop=0.0)
    if on_the_fly:
        ramp = replace(ramp, vstop=0.0, astart=0.0, dfinal=0.0)
    ramp = replace(ramp, dfinal=min(ramp.dfinal, ramp.dmax), astart=min(ramp.astart, ramp.amax))
    values = {name: value for name, value in asdict(ramp).items() if name != "dstop"}
    return RampSet({name: value for name, value in values.items() if names is None or name in names}, shape)


def random_sequence(source: random.Random, *, by_pin: bool) -> Sequence:
    shape: Shape = source.choice(("s", "s", "trapezoid", "hold"))
    ramp = ramp_set(source, shape, by_pin)
    shadow = None
    if source.random() < 0.6:
        option = source.choice((0, {"s": 1, "trapezoid": source.choice((2, 3)), "hold": 2}[shape]))
        count = 1 if option == 0 else source.choice((1, 2))
        names = SETS[option]
        sets = tuple(ramp_set(source, shape, by_pin, names) for _ in range(count))
        shadow = Shadow(option, sets, source.random() < 0.5, source.choice((0, 0, 1, 2)))
    reach = round(ramp.get("vmax") * source.choice((0.05, 0.3)))
    targets: list[int] = []
    while len(targets) < source.randint(1, 8):
        target = source.randint(-reach, reach)
        if target not in targets[-1:] and target != 0:
            targets.append(target)
    pulses: list[float] = []
    if by_pin:
        at = 0.01
        for _ in range(source.randint(1, 8)):
            pulses.append(at)
            at += source.choice((0.003, 0.1, 0.5, 1.5))
    return Sequence(
        position=0,
        targets=tuple(targets),
        ramp=ramp,
        trigger="start" if by_pin else "target",
        shadow=shadow,
        delay=source.choice((0, 0, 1600, 64_000)),
        zero_wait=source.choice((0, 0, 32_000)),
        pulses_s=tuple(pulses),
        immediate=source.random() < 0.3,
        active_high=True,
        ring=source.random() < 0.4,
        moves_most=12,
    )


def set_up(sequence: Sequence, found: Motion) -> Rig:
    """A chip with the ramp and the words of the sequence, in their order; what triggers comes last."""
    rig = Rig()
    rig.ramp(Ramp(**dict(sequence.ramp.values)), RAMPMODES[sequence.ramp.shape])
    rig.write("TZEROWAIT", sequence.zero_wait)
    rig.wait(0.01)
    for name, word in found.words:
        rig.write(name, word)
    return rig


def foreseen(found: Motion, at: float) -> tuple[float, float]:
    """Where it is then, and how fast."""
    begun = [move for move in found.moves if move.start_s <= at]
    if not begun:
        return 0.0, 0.0
    time_s = np.array([at])
    return float(begun[-1].position_at(time_s)[0]), float(begun[-1].velocity_at(time_s)[0])


def after_braking(found: Motion, at: float) -> bool:
    """Whether a target came while the motor braked, and it has not been at rest since: the ways may differ then."""
    since = False
    for n, move in enumerate(found.moves):
        if move.start_s > at:
            break
        since = move.braking or (since and not found.moves[n - 1].reached)
    return since


def follow(source: random.Random, sequence: Sequence) -> None:
    """Let an emulated chip make it, look at random instants, and hold it to what was foreseen."""
    found = motion(sequence)
    rig = set_up(sequence, found)
    begin_s = rig.now_s
    end_s = max(found.duration_s, *(0.0, *sequence.pulses_s))
    looks = [(source.uniform(0, found.duration_s), "look") for _ in range(30)]
    looks += [(at, "high") for at in sequence.pulses_s] + [(at + PULSE_S, "low") for at in sequence.pulses_s]
    fastest = max((move.ramp.get("vmax") for move in found.moves), default=0.0)
    for at, what in sorted(looks):
        rig.now_s = begin_s + at
        if what != "look":
            rig.patch(pins={"start": what == "high"})
            continue
        if after_braking(found, at):
            continue
        ticks = 4 * (1 + sum(move.start_s <= at for move in found.moves))  # each arrival and each delay is rounded up
        around = [foreseen(found, at + n * ticks * TICK_S)[0] for n in (-1, -0.5, 0)]
        slack = 2.0 + ticks * TICK_S * fastest
        assert min(around) - slack <= rig.position <= max(around) + slack
    if not found.ends:
        return
    rig.now_s = begin_s + end_s + 0.5
    assert rig.state().ramp.kind == "rest"
    if found.moves:
        assert rig.position == found.moves[-1].target
        assert rig.read("AMAX") == round(found.ramp.get("amax") * 4)
    assert rig.state().ramp.starts == len(found.starts_s)


@pytest.mark.sheet("DS-TMC4361", "10.2")
@pytest.mark.parametrize("seed", range(60))
def test_an_emulated_chip_makes_it_alone_as_foreseen(seed: int) -> None:
    source = random.Random(seed)
    follow(source, random_sequence(source, by_pin=False))


@pytest.mark.sheet("DS-TMC4361", "10.2")
@pytest.mark.parametrize("seed", range(60))
def test_pulses_at_start_lead_it_as_foreseen(seed: int) -> None:
    source = random.Random(1000 + seed)
    follow(source, random_sequence(source, by_pin=True))


# --- what does not work, or not as it seems ---------------------------------------------------------------------------


def test_a_target_twice_stops_a_sequence_by_its_target() -> None:
    found = motion(Sequence(0, (100, 200, 200, 300), BASE))
    assert [move.target for move in found.moves] == [100, 200]
    assert "the target after move 2 is the same place" in found.findings[0]


def test_a_first_target_where_it_stands_begins_nothing() -> None:
    found = motion(Sequence(100, (100, 200), BASE))
    assert not found.moves
    assert "nothing begins" in found.findings[0]


def test_pulses_while_the_delay_runs_are_lost() -> None:
    found = motion(Sequence(0, (100, 200), BASE, "start", delay=16_000, pulses_s=(0.1, 0.1005, 1.0)))
    assert found.starts_s == pytest.approx((0.101, 1.001))
    assert found.findings == ("1 of 3 pulses come while START_DELAY runs, and are lost",)


def test_the_words_name_what_moves_last() -> None:
    found = motion(Sequence(0, (100, 200, 300), BASE, ring=True, delay=7))
    assert dict(found.words)["START_CONF"] == BY_TARGET | PIPE | 1 << (24 + 1)
    assert dict(found.words)["START_DELAY"] == 7
    assert found.words[-1] == ("XTARGET", 100)
    assert [word for name, word in found.words if name.startswith("X_PIPE")] == [200, 300] + [300] * 6
    assert not found.ends
    assert len(found.moves) == 20
    assert found.moves[1].origin == 100


def test_a_curve_has_the_ends_of_all_moves() -> None:
    found = motion(Sequence(0, (100, -50), BASE, delay=160_000))
    time_s, position, velocity = found.curve(50)
    assert np.all(np.diff(time_s) > 0)
    assert position[-1] == -50
    assert velocity[time_s == found.moves[1].start_s] == 0
    assert found.moves[1].start_s == pytest.approx(found.moves[0].end_s + 0.01)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"targets": ()}, "1 to 9 targets"),
        ({"targets": tuple(range(10))}, "1 to 9 targets"),
        ({"targets": (1 << 31,)}, "target 1 is -2"),
        ({"position": -(1 << 31), "targets": (5,)}, "the other way round"),
        ({"delay": -1}, "START_DELAY is 0"),
        ({"moves_most": 65}, "1 to 64 moves"),
        ({"pulses_s": (1.0, 1.0)}, "their times rise"),
        ({"pulses_s": (-1.0,)}, "none before 0 s"),
        ({"ramp": RampSet({"vmax": 1e9})}, "VMAX is"),
        ({"ramp": RampSet({})}, "vmax is above 0"),
    ],
)
def test_what_cannot_be_is_said(change: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        motion(replace(Sequence(0, (100,), BASE), **change))


@pytest.mark.parametrize(
    ("option", "sets", "misses", "said"),
    [
        (4, (BASE,), 0, "shadow_option is 0 to 3"),
        (0, (BASE, BASE), 0, "has 1 to 1 sets"),
        (1, (BASE,), 16, "shadow_miss_cnt is 0 to 15"),
        (2, (RampSet({"bow1": 1.0}),), 0, "hold vmax"),
    ],
)
def test_shadow_registers_that_cannot_be(option: int, sets: tuple[RampSet, ...], misses: int, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Shadow(option, sets, misses=misses)


def test_a_ramp_has_no_other_registers() -> None:
    with pytest.raises(ValueError, match="no ramp register 'vmin'"):
        RampSet({"vmin": 1.0})
