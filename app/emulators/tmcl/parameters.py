"""Axis parameters that the firmware keeps and turns into registers of the drive under it.

What moves the motor or only tells (positions, flags, switches) is in `axis`. How speeds count, and which registers
follow, is the module's: `sixpoint`, `trapezoid`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import ClassVar

from ...registers.model import Register, Space, to_signed
from ...registers.tmcl.description import TmclModule
from ..drive import Drive
from . import units
from .refused import invalid_value, wrong_type

TARGET_SPEED, SPEED, ACCELERATION, CURRENT, STANDBY_CURRENT = 2, 4, 5, 6, 7
RIGHT_OFF, LEFT_OFF, RAMP_MODE, MICROSTEPS, STOP_ON_STALL = 12, 13, 138, 140, 181
SEARCH_MODE, SEARCH_SPEED, SWITCH_SPEED, DEVIATION, DOUBLE_EDGE, STEP_DIR = 193, 194, 195, 212, 161, 254
CURRENT_STEP = 8
"""The driver makes 32 steps of the 256 values of a current."""
CURRENT_LOOP = 4 << 24 | 12 << 28
"""PWM_REG and PWM_LIM as the chip has them after reset."""
MULTISTEP_FILTER = 1 << 3

Configuration = Callable[[int], int]
"""A global parameter of bank 0."""
Forced = Callable[[], bool | None]
"""What a reference search makes of the stop switches: on, off, or None: as configured."""


class Parameters(ABC):
    """Values by number, and the drive made to follow them."""

    SPEEDS: ClassVar[frozenset[int]]
    ACCELERATIONS: ClassVar[frozenset[int]]
    OURS: ClassVar[Mapping[int, int]]
    """What parameters are after power-on, where the table names no value."""
    NULL_SWITCH: ClassVar[bool] = False
    """Whether parameter 210 has the encoder cleared at its next null; else it is its prescaler."""

    def __init__(self, module: TmclModule, drive: Drive, stops_forced: Forced, configuration: Configuration) -> None:
        self._drive = drive
        self._stops_forced = stops_forced
        self._configuration = configuration
        self.rows = module.rows(Space.AXIS)
        self.defaults = self.defaults_of(self.rows)
        self.values: dict[int, int] = {}
        """Everything that is no speed or acceleration, as it was written."""
        self.shown: dict[int, int] = {}
        """Speeds and accelerations as GAP shows them."""
        self._chip: dict[int, int] = {}
        self.positioning = False
        """Whether VMAX of the chip is the positioning speed now."""

    @classmethod
    def defaults_of(cls, rows: Mapping[int, Register]) -> dict[int, int]:
        """As delivered, by number, in the unit that a speed is written in then."""
        return {
            number: to_signed(row.reset, 32) if row.reset is not None else cls.OURS.get(number, 0)
            for number, row in rows.items()
        }

    def power_on(self, kept: Mapping[int, int]) -> None:
        """Defaults everywhere but for what the EEPROM has `kept`, and the drive set up."""
        self.values.clear()
        values = {**self.defaults, **kept}
        self._start(values)
        for number, value in values.items():
            if self.counts(number):
                self.keep(number, value)
            else:
                self.values[number] = value
        self.apply_all()

    def counts(self, number: int) -> bool:
        """Whether it is a speed or an acceleration."""
        return number in self.SPEEDS or number in self.ACCELERATIONS

    def held(self, number: int) -> int:
        """A parameter that is kept here, as it was written."""
        return self.shown[number] if self.counts(number) else self.values[number]

    def in_chip_units(self, number: int) -> int:
        """A speed or acceleration as the chip counts it."""
        return self._chip[number]

    @property
    def microsteps(self) -> int:
        """Microsteps of a full step."""
        return 1 << self.values[MICROSTEPS]

    def check(self, number: int, value: int) -> None:
        """Raises Refused: status 3 for a parameter that cannot be written, 4 for a value out of range."""
        row = self.rows.get(number)
        if row is None or not row.access.writable:
            raise wrong_type()
        low, high = self._limits(number)
        if not low <= value <= high or (row.values and value not in row.values):
            raise invalid_value()

    def _limits(self, number: int) -> tuple[int, int]:
        return self.rows[number].minimum, self.rows[number].maximum

    @abstractmethod
    def _start(self, values: Mapping[int, int]) -> None:
        """What has to be before speeds can be kept, at power-on with these values."""

    @property
    @abstractmethod
    def speed_scale(self) -> tuple[float, float]:
        """So many of the chip's units of velocity are so many of the user's."""

    def speed_shown(self, chip_units: int) -> int:
        """A velocity of the chip in the user's unit."""
        chip, user = self.speed_scale
        shown = int(abs(chip_units) * user / chip + 0.5)
        return shown if chip_units >= 0 else -shown

    @abstractmethod
    def write(self, number: int, value: int) -> None:
        """SAP of a parameter that is kept here; `check` has let it through."""

    @abstractmethod
    def keep(self, number: int, value: int) -> None:
        """A speed or acceleration; what the user wrote comes back as it was."""

    @abstractmethod
    def apply_all(self) -> None:
        """Every register of the drive."""

    @abstractmethod
    def apply_ramp(self) -> None:
        """Registers of the ramp."""

    @abstractmethod
    def apply_switches(self) -> None:
        """Stop switches, and the stop on stall, which a speed of 0 switches off."""

    @abstractmethod
    def configured(self, number: int) -> None:
        """Global parameter `number` of bank 0 was written."""

    # --- what all drives have alike --------------------------------------------------------------

    def _stops(self) -> tuple[int, int]:
        """Whether the left and the right switch stop the motor now."""
        forced = self._stops_forced()
        left = not self.values[LEFT_OFF] if forced is None else forced
        right = not self.values[RIGHT_OFF] if forced is None else forced
        return int(left), int(right)

    def _apply_coolstep(self) -> None:
        values = self.values
        word = values[172] | values[171] << 5 | values[170] << 8 | values[169] << 13 | values[168] << 15
        self._drive.write("COOLCONF", word | (values[174] & 0x7F) << 16 | values[173] << 24)

    def _currents(self) -> int:
        """IHOLD_IRUN without a delay."""
        run, hold = self.values[CURRENT] // CURRENT_STEP, self.values[STANDBY_CURRENT] // CURRENT_STEP
        return hold | run << 8

    def _power_down(self) -> int:
        """TPOWERDOWN."""
        return min(round(self.values[214] * 0.01 / units.DELAY_S), 255)
