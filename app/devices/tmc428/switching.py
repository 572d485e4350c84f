"""What differs between the chips of this family beside their registers' names: switches, status bits, the way out."""

from __future__ import annotations

from abc import ABC, abstractmethod

from ..core.register_io import RegisterIO
from ..core.register_samples import Asked
from ..core.sample_plan import Decoder, FloatArray, IntArray


class Switching(ABC):
    """The switches of one chip and its status bits, by what was last seen of its global registers."""

    status_names: tuple[str, ...]
    """Names of the status bits of each reply, bit 0 first, "" where unused."""

    @abstractmethod
    async def read(self, io: RegisterIO, axis: int) -> tuple[bool | None, bool | None]:
        """Left and right switch; None where there is none."""

    @abstractmethod
    def decoder(self, side: str, axis: int, asked: Asked) -> Decoder:
        """Of samples: the switch "left", "right" or "reference"; NaN where there is none."""

    @abstractmethod
    def reached(self, status: int, axis: int) -> bool:
        """Whether the status bits say that `axis` is at its target (xEQt)."""

    @abstractmethod
    def reached_column(self, status: IntArray, axis: int) -> FloatArray:
        """The same of a column of status bits."""

    def problem(self) -> tuple[str, str] | None:
        """Why switches cannot be trusted at rest, and the way out, by the registers last seen; None where they can."""
        return None

    def latency_s(self) -> float:
        """How old the switch states of a chip at rest may be, device time [s]."""
        return 0.0

    async def motion_warnings(self, io: RegisterIO) -> list[str]:
        """Why steps may not get to the motor although the ramp generator runs."""
        del io
        return []
