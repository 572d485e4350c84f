"""A sequence of targets that a TMC4361 makes alone: its pipeline and shadow registers as words, and the whole motion.

Each start moves the target pipeline on by one, and may exchange the ramp registers with shadow registers. Starts come
from TARGET_REACHED or from the pin START; START_CONF has one choice of triggers for all of them. The registers are
worked out one start after the other, the ways between by the planner of app/calc/ramps, in continuous time: the chip
rounds each delay and each arrival up to its 64 clocks.

Facts: NOTES-TMC4361-RAMPS 7; TMC4361A (headers).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Literal

import numpy as np

from ..ramps.curve import FloatArray
from ..ramps.sramp import SRamp, position_plan
from ..ramps.sramp_plan import SRampPlan
from ..ramps.sramp_trapezoid import Trapezoid, hold_position_plan, trapezoid_position_plan
from ..units.tmc4361 import Units

Shape = Literal["s", "trapezoid", "hold"]
Trigger = Literal["target", "start"]
STAGES = 8
MOVES_MOST = 64
PULSES_MOST = 64
RAMPMODES: Mapping[Shape, int] = {"hold": 4, "trapezoid": 5, "s": 6}
REGISTERS = (
    *("vmax", "amax", "dmax", "astart", "dfinal", "vbreak", "vstart", "vstop"),
    *("bow1", "bow2", "bow3", "bow4"),
)
SETS: Mapping[int, tuple[str, ...]] = {
    0: REGISTERS,
    1: ("vmax", "amax", "dmax", "bow1", "bow2", "bow3", "bow4"),
    2: ("vmax", "amax", "dmax", "astart", "dfinal", "vbreak", "vstart"),
    3: ("vmax", "amax", "dmax", "astart", "dfinal", "vbreak", "vstop"),
}
"""What a set of shadow registers holds by shadow_option, in their order; with option 0 RAMPMODE comes after it."""
_SECOND_SET = 7
_SHADOW_EN, _BY_PIN, _BY_TARGET, _ACTIVE_HIGH, _IMMEDIATE, _PIPE_XTARGET = (1 << bit for bit in (4, 5, 6, 9, 10, 12))
_OPTION, _CYCLIC, _MISSES, _REWRITE = 16, 18, 20, 24
_INT32 = 1 << 31


@dataclass(frozen=True)
class RampSet:
    """Ramp registers in pps, pps^2, pps^3, and the shape that RAMPMODE has; what is not named is 0."""

    values: Mapping[str, float]
    shape: Shape = "s"

    def __post_init__(self) -> None:
        unknown = [name for name in self.values if name not in REGISTERS]
        if unknown:
            raise ValueError(f"there is no ramp register {unknown[0]!r}; known: {', '.join(REGISTERS)}")

    def get(self, name: str) -> float:
        return self.values.get(name, 0.0)

    def held(self, units: Units) -> RampSet:
        """As the registers hold it. Raises ValueError for what does not fit."""
        return RampSet({name: units.held(name.upper(), self.get(name)) for name in REGISTERS}, self.shape)

    def plan(self, distance: float, v: float, a: float, use_astart_and_vstart: bool) -> SRampPlan:
        """The way by `distance` [microsteps] from velocity `v` and acceleration `a`. Raises ValueError."""
        if self.shape == "hold":
            return hold_position_plan(self.get("vmax"), distance)
        if self.shape == "trapezoid":
            named = {part.name: self.get(part.name) for part in fields(Trapezoid)}
            return trapezoid_position_plan(Trapezoid(**named), distance, v, a)
        named = {name: self.get(name) for name in REGISTERS if name != "vbreak"}
        return position_plan(SRamp(**named, use_astart_and_vstart=use_astart_and_vstart), distance, v, a)


@dataclass(frozen=True)
class Shadow:
    """Shadow registers: what a start exchanges the ramp with.

    option : shadow_option, see SETS; sets : one for option 0, one or two for the others (one stands for both);
        registers that a set does not name are as in the ramp
    cyclic : cyclic_shadow_regs, what is replaced comes back; misses : shadow_miss_cnt, 0..15 starts to let pass

    Raises ValueError for what the chip cannot be told.
    """

    option: int
    sets: tuple[RampSet, ...]
    cyclic: bool = False
    misses: int = 0

    def __post_init__(self) -> None:
        if self.option not in SETS:
            raise ValueError(f"shadow_option is 0 to 3, got {self.option}")
        most = 1 if self.option == 0 else 2
        if not 1 <= len(self.sets) <= most:
            raise ValueError(f"shadow_option {self.option} has 1 to {most} sets, got {len(self.sets)}")
        if not 0 <= self.misses <= 15:
            raise ValueError(f"shadow_miss_cnt is 0 to 15, got {self.misses}")
        for ramp in self.sets:
            foreign = [name for name in ramp.values if name not in SETS[self.option]]
            if foreign:
                held = ", ".join(SETS[self.option])
                raise ValueError(f"sets of shadow_option {self.option} hold {held}, not {foreign[0]}")


@dataclass(frozen=True)
class Sequence:
    """Targets one after the other, and what leads from one to the next.

    position : where it stands; targets [microsteps]: the first goes into XTARGET where TARGET_REACHED triggers (up to 9
        then), else all of them into the pipeline (up to 8)
    trigger : TARGET_REACHED, or edges of the pin START at `pulses_s` [s], rising
    delay, zero_wait : START_DELAY and TZEROWAIT [clocks]; immediate : immediate_start_in, no START_DELAY after the pin
    ring : the pipeline goes round; moves_most : how many moves are looked at, up to 64

    Raises ValueError for what the chip cannot be told, and for ways of 2^31 microsteps or more.
    """

    position: int
    targets: tuple[int, ...]
    ramp: RampSet
    trigger: Trigger = "target"
    shadow: Shadow | None = None
    units: Units = field(default_factory=Units)
    use_astart_and_vstart: bool = False
    delay: int = 0
    zero_wait: int = 0
    pulses_s: tuple[float, ...] = ()
    immediate: bool = False
    active_high: bool = False
    ring: bool = False
    moves_most: int = 20

    def __post_init__(self) -> None:
        most = STAGES + (self.trigger == "target")
        if not 1 <= len(self.targets) <= most:
            raise ValueError(f"a sequence has 1 to {most} targets by this trigger, got {len(self.targets)}")
        for name, place in (("position", self.position), *((f"target {n}", x) for n, x in enumerate(self.targets, 1))):
            if not -_INT32 <= place < _INT32:
                raise ValueError(f"{name} is -2^31 to 2^31 - 1, got {place}")
        for name, clocks in (("START_DELAY", self.delay), ("TZEROWAIT", self.zero_wait)):
            if not 0 <= clocks < 1 << 32:
                raise ValueError(f"{name} is 0 to 2^32 - 1 clocks, got {clocks}")
        if not 1 <= self.moves_most <= MOVES_MOST:
            raise ValueError(f"1 to {MOVES_MOST} moves can be looked at, got {self.moves_most}")
        if len(self.pulses_s) > PULSES_MOST or any(not 0 <= at < math.inf for at in self.pulses_s):
            raise ValueError(f"there are up to {PULSES_MOST} pulses, none before 0 s")
        if any(later <= earlier for earlier, later in zip(self.pulses_s, self.pulses_s[1:], strict=False)):
            raise ValueError("pulses come one after the other: their times rise")

    @property
    def piped(self) -> tuple[int, ...]:
        """Targets that go into the pipeline."""
        return self.targets[1:] if self.trigger == "target" else self.targets


@dataclass(frozen=True)
class Move:
    """A way to a target.

    start_s : when the start gives the target, begin_s : when the motor moves, end_s : when it is there, or when the
        next start sends it elsewhere (`reached` False) [s]
    ramp : the registers that it is made with; braking : the motor brakes for the target before when it begins
    """

    start_s: float
    begin_s: float
    end_s: float
    origin: float
    target: int
    reached: bool
    ramp: RampSet
    plan: SRampPlan
    braking: bool = False

    def position_at(self, time_s: FloatArray) -> FloatArray:
        """[microsteps]"""
        return self.origin + self.plan.at(time_s - self.begin_s).position

    def velocity_at(self, time_s: FloatArray) -> FloatArray:
        """[pps]; at rest until the motion begins."""
        return np.where(time_s < self.begin_s, 0.0, self.plan.at(time_s - self.begin_s).velocity_pps)


@dataclass(frozen=True)
class Motion:
    """What becomes of a sequence.

    words : registers by name, in the order in which they are to be written: what sets it going comes last
    moves : see Move; starts_s : every start, also those after which nothing moves [s]
    ramp : the registers after the last start
    ends : whether it comes to rest by itself; else it goes on, and only the first moves are here
    findings : what does not work, or not as it seems
    """

    words: tuple[tuple[str, int], ...]
    moves: tuple[Move, ...]
    starts_s: tuple[float, ...]
    ramp: RampSet
    ends: bool
    findings: tuple[str, ...]

    @property
    def duration_s(self) -> float:
        """Until the last move is over."""
        return self.moves[-1].end_s if self.moves else 0.0

    def curve(self, samples: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(time [s], position [microsteps], velocity [pps]): evenly, and at the ends of moves and pieces besides."""
        if not self.moves:
            return np.zeros(0), np.zeros(0), np.zeros(0)
        times, positions, velocities = [], [], []
        even = np.linspace(0.0, self.duration_s, samples)
        for n, move in enumerate(self.moves):
            end_s = self.moves[n + 1].start_s if n + 1 < len(self.moves) else self.duration_s
            last = n + 1 == len(self.moves)
            knees = np.array([move.start_s, move.begin_s, *(move.begin_s + piece.end_s for piece in move.plan.pieces)])
            t = np.unique(np.concatenate((even, knees)))
            t = t[(t >= move.start_s) & ((t <= end_s) if last else (t < end_s))]
            times.append(t)
            positions.append(move.position_at(t))
            velocities.append(move.velocity_at(t))
        return np.concatenate(times), np.concatenate(positions), np.concatenate(velocities)


class _Chip:
    """The registers that a start changes."""

    def __init__(self, sequence: Sequence) -> None:
        self.sequence = sequence
        self.ramp = sequence.ramp.held(sequence.units)
        self.target = sequence.targets[0] if sequence.trigger == "target" else sequence.position
        piped = sequence.piped or (self.target,)
        self.pipe = [*piped, *(piped[-1:] * (STAGES - len(piped)))]
        # The stage that the last target leaves gets the old one.
        self.rewritten = len(piped) - 1 if sequence.ring else None
        self.sets: list[RampSet] = []
        self.missed = 0
        if sequence.shadow:
            self.sets = [self._full(ramp) for ramp in sequence.shadow.sets]
            if sequence.shadow.option and len(self.sets) == 1:
                self.sets.append(self.sets[0])

    def _full(self, ramp: RampSet) -> RampSet:
        whole_set = RampSet({**self.ramp.values, **ramp.values}, ramp.shape).held(self.sequence.units)
        return whole_set if self.sequence.shadow and self.sequence.shadow.option == 0 else self._of(whole_set)

    def _of(self, ramp: RampSet) -> RampSet:
        """A set that holds no RAMPMODE has the shape that there is."""
        return RampSet(ramp.values, self.ramp.shape)

    def start(self) -> None:
        """A start: the pipeline moves, and the shadow registers where it is their turn."""
        shadow = self.sequence.shadow
        if shadow and self.missed < shadow.misses:
            self.missed += 1
        elif shadow:
            self.missed = 0
            old = self.ramp
            held = SETS[shadow.option]
            new = {**old.values, **{name: self.sets[0].get(name) for name in held}}
            self.ramp = RampSet(new, self.sets[0].shape if shadow.option == 0 else old.shape)
            if len(self.sets) == 2:
                self.sets[0] = self.sets[1]
            if shadow.cyclic:
                self.sets[-1] = old
        old_target, self.target = self.target, self.pipe[0]
        self.pipe = [*self.pipe[1:], self.pipe[-1]]
        if self.rewritten is not None:
            self.pipe[self.rewritten] = old_target

    def words(self) -> tuple[tuple[str, int], ...]:
        """As they are before the first start, in the order of writing."""
        sequence, shadow = self.sequence, self.sequence.shadow
        conf = _PIPE_XTARGET | (_BY_TARGET if sequence.trigger == "target" else _BY_PIN)
        conf |= _ACTIVE_HIGH * sequence.active_high | _IMMEDIATE * sequence.immediate
        if self.rewritten is not None:
            conf |= 1 << (_REWRITE + self.rewritten)
        found = [(f"X_PIPE{n}", target) for n, target in enumerate(self.pipe)]
        if shadow:
            conf |= _SHADOW_EN | shadow.option << _OPTION | shadow.cyclic << _CYCLIC | shadow.misses << _MISSES
            for n, ramp in enumerate(self.sets):
                for place, name in enumerate(SETS[shadow.option], n * _SECOND_SET):
                    found.append((f"SH_REG{place}", sequence.units.to_raw(name.upper(), ramp.get(name))))
            if shadow.option == 0:
                found.append((f"SH_REG{len(REGISTERS)}", RAMPMODES[self.sets[0].shape]))
        found += [("START_DELAY", sequence.delay), ("START_CONF", conf)]
        return (*found, ("XTARGET", self.target)) if sequence.trigger == "target" else tuple(found)


def motion(sequence: Sequence) -> Motion:
    """The registers of a sequence and what becomes of it, from rest. Raises ValueError for what cannot be planned."""
    chip = _Chip(sequence)
    words = chip.words()
    if sequence.trigger == "target":
        moves, starts, ends, findings = _by_target(sequence, chip)
    else:
        moves, starts, ends, findings = _by_pulses(sequence, chip)
    for n, move in enumerate(moves, 1):
        if move.plan.overshoot > 0:
            findings.append(f"move {n} goes past its target and comes back: TARGET_REACHED may come on the way already")
    if sequence.ring and sequence.trigger == "start":
        findings.append("the place where it stands at first becomes part of the ring")
    return Motion(words, tuple(moves), tuple(starts), chip.ramp, ends, tuple(findings))


def _by_target(sequence: Sequence, chip: _Chip) -> tuple[list[Move], list[float], bool, list[str]]:
    clock = sequence.units.clock_hz
    moves: list[Move] = []
    starts: list[float] = []
    findings: list[str] = []
    place, start_s, begin_s = sequence.position, 0.0, 0.0
    if chip.target == place:
        return [], [], True, ["the first target is where it stands: TARGET_REACHED does not come, and nothing begins"]
    while len(moves) < sequence.moves_most:
        plan = _plan(sequence, chip, float(place), 0.0, 0.0)
        end_s = begin_s + plan.duration_s
        moves.append(Move(start_s, begin_s, end_s, float(place), chip.target, True, chip.ramp, plan))
        place = chip.target
        start_s = end_s + sequence.delay / clock
        begin_s = max(start_s, end_s + sequence.zero_wait / clock)
        chip.start()
        starts.append(start_s)
        if chip.target == place:
            made, wanted = len(moves), len(sequence.targets)
            if made < wanted or sequence.ring:
                findings.append(
                    f"the target after move {made} is the same place: TARGET_REACHED does not come again, "
                    "and the sequence stops there"
                )
            if sequence.shadow:
                findings.append("the start after the last move changes the ramp registers too")
            return moves, starts, True, findings
    return moves, starts[:-1], False, findings


def _by_pulses(sequence: Sequence, chip: _Chip) -> tuple[list[Move], list[float], bool, list[str]]:
    clock = sequence.units.clock_hz
    delay_s = 0.0 if sequence.immediate else sequence.delay / clock
    moves: list[Move] = []
    starts: list[float] = []
    findings: list[str] = []
    lost = 0
    for at in sequence.pulses_s:
        if starts and at < starts[-1]:
            lost += 1
            continue
        start_s = at + delay_s
        if len(moves) == sequence.moves_most:
            findings.append(f"only the first {sequence.moves_most} starts are looked at")
            break
        starts.append(start_s)
        x, v, a, begin_s = float(sequence.position), 0.0, 0.0, start_s
        if moves:
            before = moves[-1]
            t = start_s - before.begin_s
            if t < 0:  # it waits for TZEROWAIT, and goes elsewhere then
                x, begin_s = before.origin, before.begin_s
            elif t < before.plan.duration_s:
                seen = before.plan.at(t)
                x = before.origin + float(seen.position)
                v, a = float(seen.velocity_pps), float(seen.acceleration_pps2)
            else:
                x = float(before.target)
                begin_s = max(start_s, before.begin_s + before.plan.duration_s + sequence.zero_wait / clock)
            if t < before.plan.duration_s:
                moves[-1] = Move(
                    before.start_s,
                    min(before.begin_s, start_s),
                    start_s,
                    before.origin,
                    before.target,
                    False,
                    before.ramp,
                    before.plan,
                    before.braking,
                )
        chip.start()
        plan = _plan(sequence, chip, x, v, a)
        end_s, braking = begin_s + plan.duration_s, v * a < 0
        moves.append(Move(start_s, begin_s, end_s, x, chip.target, True, chip.ramp, plan, braking))
    braking_at = [str(n) for n, move in enumerate(moves, 1) if move.braking]
    if braking_at:
        findings.append(
            f"the motor brakes when move {', '.join(braking_at)} begins: where it ends is sure, the chip may go there "
            "a little otherwise"
        )
    if lost:
        findings.append(f"{lost} of {len(sequence.pulses_s)} pulses come while START_DELAY runs, and are lost")
    if not sequence.ring and len(starts) < len(sequence.targets):
        findings.append(f"{len(starts)} starts for {len(sequence.targets)} targets: the rest of them wait")
    if not sequence.ring and len(starts) > len(sequence.targets):
        findings.append(f"{len(starts)} starts for {len(sequence.targets)} targets: the last ones lead nowhere")
    return moves, starts, True, findings


def _plan(sequence: Sequence, chip: _Chip, x: float, v: float, a: float) -> SRampPlan:
    distance = chip.target - x
    if abs(distance) >= _INT32:
        raise ValueError(f"from {x:.0f} to {chip.target} is 2^31 microsteps or more: the chip goes the other way round")
    return chip.ramp.plan(distance, v, a, sequence.use_astart_and_vstart)


__all__ = ["REGISTERS", "SETS", "Motion", "Move", "RampSet", "Sequence", "Shadow", "motion"]
