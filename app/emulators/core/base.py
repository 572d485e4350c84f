"""What every emulated thing behind a wire has: seconds of its own, and a chip the faults of its link."""

from __future__ import annotations

import logging
import random
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Generic, Protocol, TypedDict, TypeVar

from pydantic import BaseModel, Field

from ...clock import Clock, ScaledClock
from ...deferred import DeferredModel
from ...kernels import serves_plain
from .ground_truth import GroundTruth
from .noise import flip
from .pace import Pace, Slice
from .pins import PinWire, WiredChip

log = logging.getLogger("stepscope.emulators")


class Times(TypedDict):
    """How the time of an emulator passes: the first fields of its `EmulatedState`."""

    time_scale: float
    chip_time_s: float
    time_skipped_s: float


class EmulatedState(DeferredModel):
    """What GET .../emulator answers of every emulator."""

    model: str
    time_scale: float
    chip_time_s: float
    time_skipped_s: float = Field(
        description="how long it stood still because more had to be worked out than this machine can in time [s]"
    )


class Change(Protocol):
    """What PATCH .../emulator takes for every emulator."""

    @property
    def time_scale(self) -> float | None: ...

    @property
    def faults(self) -> BaseModel: ...


class SharedTime(Protocol):
    """Several emulators that are brought on together (`coupling.Coupling`)."""

    def reach(self, member: object, at_s: float | None) -> float:
        """Bring all on until `member` is at `at_s` [s] of its time, by default now; where it is then [s]."""
        ...


ChangeT = TypeVar("ChangeT", bound=Change)
StateT = TypeVar("StateT", bound=BaseModel)


class EmulatorBase(ABC, Generic[ChangeT, StateT]):
    """Lives by `clock`, `time_scale` times as fast, and never by itself: whoever asks makes it catch up first."""

    def __init__(self, clock: Clock, time_scale: float, faults: ChipFaults) -> None:
        self.clock = ScaledClock(clock, time_scale)
        self.faults = faults
        self._lock: AbstractContextManager[object] = threading.Lock()
        self._shared: SharedTime | None = None
        """Whoever brings it on together with others, while its pins are wired to theirs."""
        self._latest_s = 0.0
        """Where it has been brought to, on `clock` [s]."""
        self.pace: Pace | None = None
        """Bounds the work of a catch-up; None where time waits for whoever works it out, as a test's does."""
        self._slice = Slice()
        self._skips = 0
        self.wired: WiredChip | None = None
        """The pins that can be wired to other emulators; None where it has none."""
        self.wires: Sequence[PinWire] = ()
        """Which of them are, and to which net."""

    @property
    def brought_to_s(self) -> float:
        """The latest time used, on `clock` [s]."""
        return self._latest_s

    @abstractmethod
    def _run(self, until_s: float) -> None:
        """Run to `until_s` [s], never back. The lock is held."""

    @property
    @abstractmethod
    def _quiet(self) -> bool:
        """Whether nothing will happen until a write, so that any time is passed over at once."""

    def _run_until(self, at_s: float | None) -> None:
        """Run to `at_s` [s], by default now, or as far as `pace` lets it. The lock is held."""
        self._run(self._reach(at_s))

    def _reach(self, at_s: float | None) -> float:
        """Where to run to for `at_s` [s], by default now; what is more than a little has been run then.

        With a `pace`, and more to do than that allows, the chip's clock is set to where the chip is: it stood still
        for the rest, which `clock.skipped_s` tells.
        """
        if self._shared is not None:
            return self._shared.reach(self, at_s)
        now_s = self.clock.now()
        at_s = now_s if at_s is None else at_s
        if self.pace is None:
            return at_s
        at_s = min(at_s, now_s)  # what it was asked for may have been skipped meanwhile
        if at_s - self._latest_s <= self._slice.unmeasured_s or self._quiet:
            return at_s
        allowed_s, began_s = self.pace.allowed_s(), time.thread_time()
        worked_s = 0.0
        while (before_s := self._latest_s) < at_s and worked_s < allowed_s and not self._quiet:
            self._run(min(at_s, before_s + self._slice.length_s))
            until_s = time.thread_time() - began_s
            self._slice.took(self._latest_s - before_s, until_s - worked_s)
            worked_s = until_s
        self.pace.spend(worked_s)
        if self._latest_s < at_s and not self._quiet:
            self._skip()
            return self._latest_s
        return at_s

    def _skip(self) -> None:
        self.clock.skip_to(self._latest_s)
        self._skips += 1
        if self._skips & self._skips - 1 == 0:  # 1, 2, 4, 8 ...: told, and no flood of lines
            log.log(
                logging.DEBUG if serves_plain() else logging.WARNING,  # while it is compiled that is as it should be
                "an emulated %s stood still for %.3g s of its time in all: more than can be worked out in time",
                self.model,
                self.clock.skipped_s,
            )

    @property
    @abstractmethod
    def model(self) -> str:
        """The name in the catalog."""

    # --- wires to others ------------------------------------------------------------------------

    def share_time(self, shared: SharedTime | None, lock: AbstractContextManager[object], clock: ScaledClock) -> None:
        """From now on be brought on by `shared` (None: by itself again), under `lock`, on `clock`.

        For `Coupling`, while nobody else talks to it: who waits for the lock that it had would come in beside it.
        """
        self._shared, self._lock, self.clock = shared, lock, clock

    @property
    def lock(self) -> AbstractContextManager[object]:
        """Held by whoever talks to it."""
        return self._lock

    def brought_to(self, at_s: float) -> None:
        """It has been brought to `at_s` [s] by whoever shares its time."""
        self._latest_s = max(self._latest_s, at_s)

    # --- plant ----------------------------------------------------------------------------------

    def state(self, at_s: float | None = None) -> StateT:
        """Everything that GET .../emulator answers, at chip time `at_s` [s], by default now."""
        with self._lock:
            self._run_until(at_s)
            return self._describe()

    def patch(self, change: ChangeT, at_s: float | None = None) -> StateT:
        """Change what is outside the chip at chip time `at_s` [s], by default now.

        Raises BenchError, before anything was changed, for what cannot be done to this one.
        """
        with self._lock:
            self._check(change)
            self._run_until(at_s)
            self._change(change)
            self.faults.change(change.faults)
            if change.time_scale is not None:
                self.clock.scale = change.time_scale
            return self._describe()

    def ground_truth(self, axis: int, at_s: float | None = None) -> GroundTruth:
        """How it really is with an axis at chip time `at_s` [s], by default now."""
        with self._lock:
            self._run_until(at_s)
            return self._ground_truth(axis)

    @abstractmethod
    def _describe(self) -> StateT:
        """What there is to tell at this moment. The lock is held."""

    def _check(self, change: ChangeT) -> None:
        """Raises BenchError for what cannot be done. The lock is held."""

    @abstractmethod
    def _change(self, change: ChangeT) -> None:
        """Do what has been checked, but for what every emulator has. The lock is held."""

    @abstractmethod
    def _ground_truth(self, axis: int) -> GroundTruth:
        """How it really is at this moment. The lock is held."""

    @property
    def _times(self) -> Times:
        return {
            "time_scale": self.clock.scale,
            "chip_time_s": self._latest_s,
            "time_skipped_s": self.clock.skipped_s,
        }

    # --- time ------------------------------------------------------------------------------------

    def caught_up(self, lag_s: float = 1e-9) -> bool:
        """Has it been brought to within `lag_s` [s] of its clock?"""
        return self.clock.now() - self._latest_s <= lag_s

    def catch_up(self, slice_s: float) -> bool:
        """Bring it on by at most `slice_s` [s] of its time; True once it is up to date.

        Never needed for correctness: without a `pace`, who asks after hours just waits for all of them at once.
        """
        now_s = self.clock.now()
        with self._lock:
            until_s = min(now_s, self._latest_s + slice_s)
            self._run_until(until_s)
        return until_s == now_s or self._latest_s < until_s

    def _clocks(self, until_s: float, clock_hz: float) -> int:
        """Clocks of an oscillator by `until_s` [s]; rounded so that exact instants stay exact."""
        self._latest_s = max(self._latest_s, until_s)
        return int(self._latest_s * clock_hz + 0.5)


@dataclass(slots=True)
class ChipFaults:
    """What is wrong between a chip and us at present."""

    silence: bool = False
    unplugged: bool = False
    bit_error_rate: float = 0.0

    def change(self, change: BaseModel) -> None:
        """Take what `change`, a document with fields of these names, names."""
        for name, value in change.model_dump(exclude_none=True).items():
            setattr(self, name, value)

    def require_plugged(self, model: str) -> None:
        """Raises ConnectionError while unplugged."""
        if self.unplugged:
            raise ConnectionError(f"emulated {model} is unplugged")

    def pass_on(self, model: str, reply: bytes, noise: random.Random) -> bytes:
        """What arrives of `reply`. Raises TimeoutError while silent."""
        reply = flip(reply, self.bit_error_rate, noise)
        if self.silence:
            raise TimeoutError(f"emulated {model} is silent")
        return reply
