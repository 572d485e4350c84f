"""What a family has to say for its limits to be kept: how its frames are read, and what its registers mean."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from ..axis_limits import AxisLimits
from .quantities import Motion, PositionRegister, Quantity, View

SLACK = 1 + 1e-9
"""A limit that came to its number by a conversion is not passed by the rounding of that."""


@dataclass(frozen=True, slots=True)
class AxisReading:
    """An axis right now: counter [microsteps], velocity [pps], acceleration [pps^2].

    target : where it positions to; None while it turns, or where nobody knows
    """

    position: int
    velocity_pps: float
    acceleration_pps2: float = 0.0
    target: int | None = None


class Rules(ABC):
    """One device's family, with the limits of its axes. Addresses are the family's own, whatever carries them."""

    def __init__(self, limits: Sequence[AxisLimits], clock_hz: float) -> None:
        self.limits = tuple(limits)
        self.clock_hz = clock_hz
        axes = range(len(limits))
        self.quantities: tuple[tuple[Quantity, ...], ...] = tuple(tuple(self.quantities_of(at)) for at in axes)
        self.positions: tuple[tuple[PositionRegister, ...], ...] = tuple(tuple(self.positions_of(at)) for at in axes)
        self.sources: tuple[frozenset[int], ...] = tuple(frozenset(self.sources_of(at)) for at in axes)

    # --- the table ------------------------------------------------------------------------------

    @abstractmethod
    def quantities_of(self, axis: int) -> Iterable[Quantity]:
        """Speeds, accelerations and currents."""

    @abstractmethod
    def positions_of(self, axis: int) -> Iterable[PositionRegister]:
        """Targets and counters."""

    @abstractmethod
    def sources_of(self, axis: int) -> Iterable[int]:
        """Addresses a write to which may set the axis in motion."""

    @abstractmethod
    def motion(self, axis: int, view: View, address: int | None = None) -> Motion | None:
        """What the axis does as its registers are; None where it goes nowhere. `address` was written last."""

    def motion_before(self, axis: int, view: View, address: int) -> Motion | None:
        """What the axis did before `address` is written: a write that changes nothing of it sets nothing in motion."""
        return self.motion(axis, view, address)

    # --- frames ---------------------------------------------------------------------------------

    @abstractmethod
    def writes(self, frame: bytes) -> Sequence[tuple[int, int]]:
        """(address, word) that a frame writes; none of one that writes nothing."""

    def decoder(self) -> Callable[[bytes], Sequence[tuple[int, int]]]:
        """`writes`, as directly as can be."""
        return self.writes

    @property
    def tells_more(self) -> bool:
        """Whether `concerns` has to be asked at all."""
        return False

    def concerns(self, frame: bytes) -> bool:
        """Whether a frame matters though `writes` says nothing of it: then `require_told` has to be asked."""
        return False

    def require_told(self, frame: bytes, view: View) -> Sequence[tuple[int, int]] | None:
        """For frames that do more than write registers: what they come to, or None where `writes` says it all.

        Raises WrongState for a frame that may move an axis and does not tell how.
        """
        return None

    # --- what is known --------------------------------------------------------------------------

    @abstractmethod
    def remembered(self, address: int) -> int | None:
        """What the driver knows the register to hold."""

    @abstractmethod
    def readable(self, address: int) -> bool:
        """Whether what is held there can be read."""

    def accepted(self, frame: bytes, reply: bytes) -> bool:
        """Whether the answer says that the frame was done; True where answers say nothing of that."""
        return True

    def forgotten(self, frame: bytes) -> Iterable[int]:
        """Addresses of which nobody knows what they hold once `frame` went out."""
        return ()

    @abstractmethod
    async def learn(self) -> None:
        """Read what decides and can be read; the driver hears of it by itself. Raises BenchError."""

    async def learn_for(self, command: int, type_: int, value: int) -> None:  # noqa: B027 (registers need none)
        """For commands of a module: read what this one counts from, right before it goes out. Raises BenchError."""

    # --- the watch ------------------------------------------------------------------------------

    @abstractmethod
    async def read_axis(self, axis: int) -> AxisReading:
        """The axis now. Raises BenchError."""

    @abstractmethod
    def braking(self, axis: int, reading: AxisReading, view: View) -> float | None:
        """How far the axis runs on after a stop by its ramp [microsteps]; None where nobody knows."""

    def acceleration_pps2(self, axis: int, view: View) -> float | None:
        """How fast the velocity may rise [pps^2]; None where nobody knows."""
        found = [one.value(view) for one in self.quantities[axis] if one.kind == "acceleration" and one.at_start]
        known = [value for value in found if value is not None]
        return max(known) if known else None

    def top_pps(self, axis: int, view: View) -> float | None:
        """The speed that the axis may get to [pps]; None where nobody knows."""
        found = [one.value(view) for one in self.quantities[axis] if one.kind == "velocity"]
        known = [value for value in found if value is not None]
        return max(known) if known else None
