"""Brings emulators on together whose pins are wired: an edge of one is seen at that very clock of the others.

Their times are one from the moment on that they are wired. Those of equal clocks have their ticks at the same instants:
each is put on by less than a tick of `ALIGNED_CLOCKS` for it. Where clocks differ an edge is seen rounded to a clock of
whoever sees it, and in any case at that one's next tick. Signals, such as DIAG, are looked at every `SIGNAL_S`: they
come of a motor that moves by the steps of whoever hears of it.

Nothing is tried and taken back. Only who drives a level may change it by itself, which a chip tells before
(`may_change`): it goes first, as far as its first edge, and the others follow it there. While several might, all go
tick by tick. One lock for all of them: nobody can wait for two.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

import numpy as np

from ...clock import OffsetClock, ScaledClock
from ...kernels import serves_plain
from .base import EmulatorBase
from .pace import Pace, Slice
from .pins import Cells, Level, WiredChip

log = logging.getLogger("stepscope.emulators")

ALIGNED_CLOCKS = 256
"""What the ticks of all chips divide."""
POINTS = 1024
"""Times at most by which steps are counted before they are handed on: 16 ms at 16 MHz."""
SIGNAL_S = 5e-4
"""How often a signal is looked at while something moves [s]."""
SAMPLES_WITHIN_S = 0.03
"""How long the due samples of the others may keep one waiting [s of processor time]; the rest are given up."""


class Sampler(Protocol):
    """Takes samples of an emulator that fall due by the server's clock."""

    @property
    def next_due_s(self) -> float:
        """When the next is due [s]; infinite for never."""
        ...

    def take_due(self, until_s: float, *, give_up: bool = False) -> None:
        """Take what is due until then [s], or give it up. Raises nothing."""
        ...


@dataclass(frozen=True, slots=True)
class Pin:
    """A pin of one of the emulators that are wired, by its number among them."""

    member: int
    name: str


@dataclass(slots=True)
class Net:
    """Pins that are wired together, which have levels."""

    name: str
    pins: tuple[Pin, ...]
    high: bool | None = None
    """The level that its pins were told last; None: nobody drives it."""
    told: bool = False


@dataclass(slots=True)
class StepNet:
    """Steps of one output that inputs take. `sent` is what has been handed on."""

    source: Pin
    sinks: tuple[Pin, ...]
    sent: int = 0


@dataclass(slots=True)
class SignalNet:
    """A level of one output that inputs take. `high` is what they were told last."""

    source: Pin
    sinks: tuple[Pin, ...]
    high: bool | None = None


class _Member:
    """One emulator, and how its clocks count against those of all."""

    def __init__(self, emulator: EmulatorBase[Any, Any], chip: WiredChip, sampler: Sampler | None) -> None:
        self.emulator = emulator
        self.chip = chip
        self.sampler = sampler
        self.lock_before = emulator.lock
        self.first_clock = -(-chip.clock // ALIGNED_CLOCKS) * ALIGNED_CLOCKS
        self._share = Fraction(1)

    def count_against(self, clock_hz: float) -> None:
        """All count in clocks of `clock_hz` [Hz]."""
        self._share = Fraction(self.chip.clock_hz) / Fraction(clock_hz)

    def clock_of(self, common: int) -> int:
        """Its clock at a common one: the latest that has begun."""
        return self.first_clock + common * self._share.numerator // self._share.denominator

    def clocks_of(self, common: Cells) -> Cells:
        """The same of many."""
        if self._share == 1:
            return common + self.first_clock
        return np.array([self.clock_of(int(each)) for each in common], dtype=np.int64)

    def common_of(self, clock: int) -> int:
        """The first common clock at which it has that clock."""
        return -(-(clock - self.first_clock) * self._share.denominator // self._share.numerator)

    @property
    def tick(self) -> int:
        """A tick in common clocks, rounded down to one at least."""
        return max(1, self.chip.tick_clocks * self._share.denominator // self._share.numerator)

    def seconds(self, common: int) -> float:
        return self.clock_of(common) / self.chip.clock_hz


class Coupling:
    """Emulators whose pins are wired; `SharedTime` of each of them. Made and ended while nobody talks to any."""

    def __init__(
        self,
        emulators: Sequence[tuple[EmulatorBase[Any, Any], WiredChip, Sampler | None]],
        nets: Iterable[tuple[str, Sequence[Pin]]],
        steps: Iterable[tuple[Pin, Sequence[Pin]]] = (),
        signals: Iterable[tuple[Pin, Sequence[Pin]]] = (),
    ) -> None:
        """Wire them from now on, all at the time scale of the slowest. `steps` and `signals`: outputs, and the inputs
        of each."""
        self._lock = threading.RLock()
        for emulator, _, _ in emulators:
            emulator.catch_up(float("inf"))
        self._members = [_Member(*each) for each in emulators]
        self._of = {id(member.emulator): member for member in self._members}
        self.clock_hz = max(member.chip.clock_hz for member in self._members)
        for member in self._members:
            member.count_against(self.clock_hz)
        self._nets = [Net(name, tuple(pins)) for name, pins in nets]
        self._steps = [StepNet(source, tuple(sinks), self._chip(source).sent(source.name)) for source, sinks in steps]
        self._signals = [SignalNet(source, tuple(sinks)) for source, sinks in signals]
        self._sources = {net.source.member for net in self._steps}
        self._sinks = {pin.member for net in self._steps for pin in net.sinks}
        self._at = 0
        """Common clocks that all have been brought to."""
        self._sampling = False
        self._slice = Slice()
        self._skips = 0
        first = self._members[0].emulator.clock
        self._clock = ScaledClock(first.base, min(member.emulator.clock.scale for member in self._members))
        for member in self._members:
            before = member.emulator.clock
            offset_s = member.first_clock / member.chip.clock_hz
            clock = OffsetClock(self._clock, offset_s, before.skipped_s)
            member.emulator.share_time(self, self._lock, clock)
        for sink in self._inputs:
            self._chip(sink).connect(sink.name, True)
        self._propagate()

    @property
    def _inputs(self) -> list[Pin]:
        return [pin for net in self._steps for pin in net.sinks]

    @property
    def emulators(self) -> tuple[EmulatorBase[Any, Any], ...]:
        return tuple(member.emulator for member in self._members)

    @property
    def equal_clocks(self) -> bool:
        """Whether all have the same clock, so that an edge is seen without rounding."""
        return all(member.chip.clock_hz == self.clock_hz for member in self._members)

    def end(self) -> None:
        """Cut the wires: each goes on by itself, from where it is."""
        with self._lock:
            self.reach(self._members[0].emulator, None)
            for sink in self._inputs:
                self._chip(sink).connect(sink.name, False)
            for listener in [pin for net in self._signals for pin in net.sinks]:
                self._chip(listener).receive(listener.name, None)
            for member in self._members:
                before = member.emulator.clock
                clock = ScaledClock(before.base, before.scale, before.now())
                clock.skipped_s = before.skipped_s
                for pin in {pin.name for net in self._nets for pin in net.pins if self._chip(pin) is member.chip}:
                    member.chip.receive(pin, None)
                member.emulator.share_time(None, member.lock_before, clock)

    # --- time ------------------------------------------------------------------------------------

    def reach(self, member: object, at_s: float | None) -> float:
        """Bring all on until `member` is at `at_s` [s] of its time, by default now; where it is then [s].

        With a pace, and more to do than that allows, all of them stand still for the rest.
        """
        with self._lock:
            mine = self._of[id(member)]
            self._propagate()  # what was written since
            now_s = mine.emulator.clock.now()
            pace = mine.emulator.pace
            at_s = now_s if at_s is None else at_s if pace is None else min(at_s, now_s)
            goal = mine.common_of(int(at_s * mine.chip.clock_hz + 0.5))
            if goal > self._at:
                self._take_samples(goal)
                self._run(goal, pace)
            return mine.seconds(self._at)

    def _take_samples(self, goal: int) -> None:
        """What the others' readers want to know of the time until then, before it is over."""
        samplers = [member.sampler for member in self._members if member.sampler is not None]
        if self._sampling or not samplers:
            return
        self._sampling = True
        try:
            until_s = self._clock.base_s(goal / self.clock_hz)
            end_s = time.thread_time() + SAMPLES_WITHIN_S
            while (first := min(samplers, key=lambda each: each.next_due_s)).next_due_s <= until_s:
                if time.thread_time() > end_s:
                    for sampler in samplers:
                        sampler.take_due(until_s, give_up=True)
                    return
                first.take_due(first.next_due_s)
        finally:
            self._sampling = False

    def _run(self, goal: int, pace: Pace | None) -> None:
        if pace is None:
            self._advance(goal)
            return
        allowed_s, began_s, worked_s = pace.allowed_s(), time.thread_time(), 0.0
        while (before := self._at) < goal and (worked_s < allowed_s or self._quiet):
            piece = int(self._slice.length_s * self.clock_hz) or 1
            self._advance(goal if self._quiet else min(goal, before + piece))
            until_s = time.thread_time() - began_s
            self._slice.took((self._at - before) / self.clock_hz, until_s - worked_s)
            worked_s = until_s
        pace.spend(worked_s)
        if self._at < goal:
            self._skip()

    @property
    def _quiet(self) -> bool:
        return all(member.chip.quiet for member in self._members)

    def _skip(self) -> None:
        self._clock.skip_to(self._at / self.clock_hz)
        self._skips += 1
        if self._skips & self._skips - 1 == 0:  # 1, 2, 4, 8 ...: told, and no flood of lines
            names = ", ".join(member.emulator.model for member in self._members)
            level = logging.DEBUG if serves_plain() else logging.WARNING
            log.log(level, "wired emulators (%s) stood still for %.3g s in all", names, self._clock.skipped_s)

    def _advance(self, goal: int) -> None:
        """Run all to common clock `goal`, edge by edge."""
        while self._at < goal:
            until = goal
            first = [number for number, member in enumerate(self._members) if member.chip.may_change]
            if len(first) > 1:
                tick = min(self._members[number].tick for number in first)
                until = min(goal, (self._at // tick + 1) * tick)
            if self._signals and not self._quiet:
                until = min(until, self._at + max(1, int(SIGNAL_S * self.clock_hz)))
            points = self._points(until)
            until = int(points[-1])
            recorded: dict[int, dict[str, Cells]] = {}
            order = [*first, *(number for number in range(len(self._members)) if number not in first)]
            for number in order:
                member = self._members[number]
                if number in self._sinks:
                    continue
                if number not in self._sources:
                    reached = member.chip.advance(member.clock_of(until))
                else:
                    reached, recorded[number] = member.chip.record(member.clocks_of(points))
                if reached < member.clock_of(until):
                    until = max(member.common_of(reached), self._at + 1)
                    points = np.append(points[points < until], until)
            self._hand_on(points, recorded)
            self._at = until
            for member in self._members:
                member.emulator.brought_to(member.seconds(until))
            self._propagate()

    # --- steps -----------------------------------------------------------------------------------

    def _points(self, goal: int) -> Cells:
        """Common clocks from now to `goal`, or as far as one goes at once, by which steps are counted."""
        if not self._steps or self._quiet:
            return np.array([goal], dtype=np.int64)
        first = self._at // ALIGNED_CLOCKS + 1
        points = np.arange(first, first + POINTS, dtype=np.int64) * ALIGNED_CLOCKS
        return points if points[-1] <= goal else np.append(points[points < goal], goal)

    def _hand_on(self, points: Cells, recorded: dict[int, dict[str, Cells]]) -> None:
        """Bring those that take steps to the last of `points`, with what their controllers have sent by each."""
        for net in self._steps:
            by_then = recorded[net.source.member][net.source.name][: len(points) - 1]
            sent = np.append(by_then, self._chip(net.source).sent(net.source.name))
            counts = np.diff(sent, prepend=net.sent)
            net.sent = int(sent[-1])
            for sink in net.sinks:
                member = self._members[sink.member]
                member.chip.take(sink.name, member.clocks_of(points), counts)

    # --- levels ----------------------------------------------------------------------------------

    def _chip(self, pin: Pin) -> WiredChip:
        return self._members[pin.member].chip

    def _propagate(self) -> None:
        """Have each pin hear what the others on its net drive; what comes of it too, as far as it settles."""
        for net in self._signals:
            high = self._chip(net.source).signal(net.source.name)
            if high != net.high:
                net.high = high
                for pin in net.sinks:
                    self._chip(pin).receive(pin.name, high)
        for _ in range(4 * len(self._nets)):
            if not any(self._tell(net) for net in self._nets):
                return

    def _tell(self, net: Net) -> bool:
        levels = [self._chip(pin).level(pin.name) for pin in net.pins]
        high = _resolved([level for level in levels if level is not None])
        changed = net.high != high or not net.told
        if changed:
            net.high, net.told = high, True
            for pin in net.pins:  # who drives it sees it too: the pin is one
                self._chip(pin).receive(pin.name, high)
        return changed


def _resolved(levels: Sequence[Level]) -> bool | None:
    """The level of a net: an active one wins; None where nobody drives it."""
    if not levels:
        return None
    return next((level.high for level in levels if level.active), levels[0].high)


def groups(nets: Sequence[Sequence[int]]) -> Iterator[set[int]]:
    """Members that hang together, by nets of their numbers."""
    left = [set(net) for net in nets]
    while left:
        group = left.pop()
        while True:
            touching = [net for net in left if net & group]
            if not touching:
                break
            group = group.union(*touching)
            left = [net for net in left if not net & group]
        yield group
