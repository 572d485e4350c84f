"""What drivers ask of the soft limits of their axes. `devices.limits.limiter` fulfils it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol

from .axis_limits import AxisLimits


class LimitGuard(Protocol):
    """The soft limits of one device."""

    @property
    def limits(self) -> tuple[AxisLimits, ...]: ...

    def saw(self, address: int, word: int, width: int = 32) -> None:
        """The register of `width` bits was read."""
        ...

    def at(self, axis: int, position: int) -> None:
        """The counter was read [microsteps]."""
        ...

    def forget(self) -> None:
        """It may be another chip, or the same after a reset."""
        ...

    def reset(self) -> None:
        """The chip was reset: what went out is true no more."""
        ...

    async def learn(self) -> None:
        """Read what the limits depend on and can be read. Raises BenchError."""
        ...

    async def learn_for(self, command: int, type_: int, value: int) -> None:
        """For commands of a module: read what this one counts from, before it goes out. Raises BenchError."""
        ...

    def check(self, frames: Sequence[bytes]) -> None:
        """Raises SoftLimit, or WrongState where a frame does not tell what it comes to."""
        ...

    def check_writes(self, writes: Iterable[tuple[int, int]]) -> None:
        """Raises SoftLimit where one of these (address, word), in this order, would go beyond a limit."""
        ...

    def affects_limits(self, address: int) -> bool:
        """Whether a write there can go beyond a limit."""
        ...

    def require_target(self, axis: int, target: int, position: int | None = None, what: str = "") -> None:
        """Raises SoftLimit for a target [microsteps] outside the range, unless it is on the way back into it."""
        ...

    def require_way(self, axis: int, way: float, position: int | None = None) -> None:
        """Raises SoftLimit where the axis is at the end of its range and is to turn on that way."""
        ...

    def require_velocity(self, axis: int, velocity_pps: float) -> None:
        """Raises SoftLimit for a speed beyond the limit."""
        ...

    def rounded(self, axis: int, counts: int, unit_pps: float) -> int:
        """A velocity in the chip's counts, not above the limit by having been rounded."""
        ...

    def findings(self, axis: int) -> list[str]:
        """What the chip holds beyond the limits, and what to write."""
        ...
