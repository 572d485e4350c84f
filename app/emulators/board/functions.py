"""What the firmware has for the chip in its slot: set it up, move its motors, name its registers as parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol


class AxisFunctions(Protocol):
    """One motor. Numbers that cannot be raise Refusal."""

    def rotate(self, velocity: int) -> None:
        """Turn at a velocity, by its sign; 0 stops."""
        ...

    def move_to(self, position: int) -> None:
        """Go to a position at the velocity of parameter 4."""
        ...

    def move_by(self, distance: int) -> int:
        """Go on from where the chip is; the new target."""
        ...

    def get(self, number: int) -> int:
        """Axis parameter `number`."""
        ...

    def set(self, number: int, value: int) -> None:
        """Set it."""
        ...


class BoardFunctions(Protocol):
    """The functions of the board in slot 1."""

    @property
    def board_id(self) -> int:
        """What it calls itself (`CHANNEL_1_BOARDS`)."""
        ...

    @property
    def driver_id(self) -> int:
        """The board in slot 2 that goes with it; 0 for none."""
        ...

    @property
    def axes(self) -> Sequence[AxisFunctions]:
        """Its motors."""
        ...

    def power_on(self) -> None:
        """Chip and microcontroller have just got their supply."""
        ...

    def reset(self) -> None:
        """Commands 152 and 143."""
        ...

    def user_function(self, number: int, motor: int, value: int) -> int:
        """Command 144. Raises Refusal."""
        ...
