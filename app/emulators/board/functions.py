"""What the firmware has for the chip in its slot: set it up, move its motors, name its registers as parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from .refusal import wrong_type


class AxisFunctions(Protocol):
    """One motor. Numbers that cannot be raise Refusal."""

    measured_velocity: int
    """The axis parameter that is the measured velocity; other commands tell it too."""

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


Read = Callable[[], int]
Write = Callable[[int], None]


class Parameters:
    """Axis parameters by number: how each is read, and written where it can be."""

    measured_velocity = 29

    def __init__(self, known: dict[int, tuple[Read, Write | None]]) -> None:
        self._parameters = known

    def get(self, number: int) -> int:
        """Raises Refusal for a parameter that there is not."""
        if number not in self._parameters:
            raise wrong_type()
        return self._parameters[number][0]()

    def set(self, number: int, value: int) -> None:
        """Raises Refusal for a parameter that there is not or can only be read, and for a value that it cannot have."""
        _, write = self._parameters.get(number, (None, None))
        if write is None:
            raise wrong_type()
        write(value)


class DriverFunctions(Protocol):
    """The functions of the board in slot 2; it has one motor."""

    measured_velocity: int

    @property
    def board_id(self) -> int:
        """What it calls itself (`CHANNEL_2_BOARDS`)."""
        ...

    def get(self, number: int) -> int:
        """Axis parameter `number`, where the board in slot 1 has none of it. Raises Refusal."""
        ...

    def set(self, number: int, value: int) -> None:
        """Set it. Raises Refusal."""
        ...

    def read(self, address: int) -> int:
        """Command 149."""
        ...

    def write(self, address: int, value: int) -> None:
        """Command 147."""
        ...

    def reset(self) -> None:
        """Command 152."""
        ...

    def user_function(self, number: int, value: int) -> int:
        """Command 145. Raises Refusal."""
        ...


class BoardFunctions(Protocol):
    """The functions of the board in slot 1."""

    @property
    def board_id(self) -> int:
        """What it calls itself (`CHANNEL_1_BOARDS`)."""
        ...

    @property
    def driver(self) -> DriverFunctions | None:
        """The board in slot 2 that goes with it."""
        ...

    @property
    def measures_velocity(self) -> bool:
        """Whether it tells how fast its motors are: axis parameter 29, commands 68 and 150."""
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

    def pass_time(self, until_s: float, chip_s: float) -> None:
        """Do what is done unasked until `until_s` [s]; the chip already stands at `chip_s`."""
        ...

    def user_function(self, number: int, motor: int, value: int) -> int:
        """Command 144. Raises Refusal."""
        ...
