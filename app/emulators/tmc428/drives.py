"""Drivers of the chain that do what its datagrams say: TMC26x with their motors, beside TMC236 without.

The chain is one long shift register: the first bits of a datagram end up in the driver next to SDI_S, the first one,
and what was in there comes back first. A driver takes over what it holds when the datagram ends. Where its bits in the
RAM are as many as it has, its word hangs on its own motor's signals alone, and is made once for each of them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from typing import NamedTuple

from ..drive import DriveOptions
from ..drive.documents import MotorState, TruthState, motor_state, truth_state
from ..drive.tmc26x import BITS, Tmc26x
from ..motor_documents import change_load
from .chain import DRIVER_BITS, Selects, Signals
from .options import DriverChange, EmulatorOptions
from .state import DriverLoadState

LEAST_SUPPLY_V = 8.0


class Record(NamedTuple):
    """A datagram as it left: its end [clocks of the outside], signals by motor, covered, and whether its answer is
    kept."""

    end: int
    motors: tuple[Signals, ...]
    covered: bool
    captured: bool


class Composed(NamedTuple):
    """A datagram on its way: words of the drivers, or all of its bits where those are not on the drivers' borders."""

    end: int
    words: tuple[int, ...] | None
    bits: tuple[int, ...]
    captured: bool


Compose = Callable[[Record], Sequence[int]]
"""The bits of a datagram with the RAM as it is."""


class ChainDrives:
    """The drivers in their order. Their clocks are those of the outside, which a power cycle of the chip leaves."""

    def __init__(self, options: EmulatorOptions) -> None:
        self.drivers: tuple[Tmc26x | None, ...] = tuple(
            _driver(options, index) if one.driver == "tmc2660" else None for index, one in enumerate(options.drivers)
        )
        self.lengths = tuple(DRIVER_BITS if driver is None else BITS for driver in self.drivers)
        self.answer: tuple[int, ...] = ()
        """The bits that came back with the captured datagram."""
        self._told: list[int | None] = [None] * len(self.drivers)
        """What each was told last."""
        self._pending: deque[Composed] = deque()
        self._words: dict[tuple[int, Signals], int] = {}

    def reset(self) -> None:
        """Power came back: registers are 0; shafts stay."""
        self._pending.clear()
        self.forget_words()
        self._told = [None] * len(self.drivers)
        for driver in self.drivers:
            if driver is not None:
                driver.reset()

    def forget_words(self) -> None:
        """The RAM, or what the signals are made of, is another now."""
        self._words.clear()

    @property
    def quiet(self) -> bool:
        """Nothing happens until a datagram comes."""
        return not self._pending and all(driver is None or driver.quiet for driver in self.drivers)

    # --- datagrams -------------------------------------------------------------------------------

    def take(self, record: Record, lengths: Sequence[int], compose: Compose, selects: Selects) -> None:
        """A datagram has left; `lengths` are the bits of each driver in the RAM. Drivers whose chip selects are wired
        otherwise than the chip drives them keep what they had."""
        if not selects.fit:
            return
        if selects.chip and tuple(lengths) != self.lengths:
            self._pending.append(Composed(record.end, self._own(compose(record), lengths), (), record.captured))
            return
        if tuple(lengths) != self.lengths or record.covered:
            bits = tuple(compose(record))
            self._pending.append(Composed(record.end, None, bits, record.captured))
            return
        words = []
        for index, signals in enumerate(record.motors[: len(self.drivers)]):
            word = self._words.get((index, signals))
            if word is None:
                word = self._words[index, signals] = self._split(compose(record))[index]
            words.append(word)
        self._pending.append(Composed(record.end, tuple(words), (), record.captured))

    def _own(self, bits: Sequence[int], lengths: Sequence[int]) -> tuple[int, ...]:
        """What each driver with a select of its own holds: the last bits of its part, after zeros where there are too
        few (a choice: what it held before is shifted on)."""
        words, at = [], 0
        for length, own in zip((*lengths, *[0] * len(self.lengths)), self.lengths, strict=False):
            words.append(_number(bits[at : at + length]) & (1 << own) - 1)
            at += length
        return tuple(words)

    def _split(self, bits: Sequence[int]) -> list[int]:
        words, at = [], 0
        for length in self.lengths:
            words.append(_number(bits[at : at + length]))
            at += length
        return words

    def advance(self, clock: int, statuses: Sequence[int]) -> None:
        """Bring all drivers to `clock`; `statuses` are those of drivers without a motor."""
        while self._pending and self._pending[0].end <= clock:
            self._shift(self._pending.popleft(), statuses)
        for driver in self.drivers:
            if driver is not None:
                driver.advance(clock)

    def _shift(self, datagram: Composed, statuses: Sequence[int]) -> None:
        words = datagram.words
        if words is None or datagram.captured:
            for driver in self.drivers:
                if driver is not None:
                    driver.advance(datagram.end)
            sent = datagram.bits if words is None else self._bits_of(words)
            stream = (*self._bits_of(self._answers(statuses)), *sent)
            if datagram.captured:
                self.answer = stream[: len(sent)]
            words = tuple(self._split(stream[len(sent) :]))
        for index, driver in enumerate(self.drivers):
            if driver is not None and words[index] != self._told[index]:
                driver.advance(datagram.end)
                driver.write(words[index])
                self._told[index] = words[index]

    def _answers(self, statuses: Sequence[int]) -> list[int]:
        return [statuses[index] if driver is None else driver.answer for index, driver in enumerate(self.drivers)]

    def _bits_of(self, words: Sequence[int]) -> list[int]:
        return [
            word >> bit & 1
            for word, length in zip(words, self.lengths, strict=True)
            for bit in range(length - 1, -1, -1)
        ]

    # --- plant -----------------------------------------------------------------------------------

    def shaft_fullsteps(self, index: int) -> float | None:
        """Where the rotor of a motor is [full steps]; None of a driver without."""
        driver = self.drivers[index] if index < len(self.drivers) else None
        return None if driver is None else driver.drive.plant.rotor_fullsteps

    def turn_by_hand(self, index: int, fullsteps: float) -> None:
        """Put a shaft there."""
        driver = self.drivers[index] if index < len(self.drivers) else None
        if driver is not None:
            driver.drive.plant.rotor_fullsteps = fullsteps

    def has_motor(self, index: int) -> bool:
        """Whether the driver has a motor with physics."""
        return index < len(self.drivers) and self.drivers[index] is not None

    def change(self, change: DriverChange) -> None:
        """Motor, load, temperature and supply; there is such a driver."""
        driver = self.drivers[change.axis]
        assert driver is not None  # it has been checked
        if change.supply_v is not None:
            driver.drive.plant.supply_v = change.supply_v
        change_load(driver.drive.plant, change)

    def describe(self, index: int) -> tuple[MotorState, TruthState, DriverLoadState] | None:
        """Motor, shaft and what acts on them as the API tells them; None of a driver without."""
        driver = self.drivers[index] if index < len(self.drivers) else None
        if driver is None:
            return None
        plant = driver.drive.plant
        load = DriverLoadState(
            load_torque_nm=plant.load_torque_nm,
            friction=plant.extra_friction_nm,
            blocked=plant.blocked,
            supply_v=plant.supply_v,
        )
        return motor_state(plant, driver.drive.options.motor), truth_state(driver.drive.plant_state), load


def _driver(options: EmulatorOptions, index: int) -> Tmc26x:
    """Raises ValueError for a motor that cannot be computed, or a clock that its driver has not."""
    one = options.drivers[index]
    start = options.stages[index].start_fullsteps if index < len(options.stages) else 3750.0
    made = Tmc26x(
        DriveOptions(
            motor=one.motor,
            load=one.load,
            clock_hz=options.clock_hz,
            supply_v=one.supply_v,
            supply_resistance_ohm=one.supply_resistance_ohm,
            full_scale_a=one.full_scale_a,
            start_fullsteps=start,
            seed=options.seed + index,
        )
    )
    made.drive.least_supply_v = LEAST_SUPPLY_V
    return made


def _number(bits: Sequence[int]) -> int:
    word = 0
    for bit in bits:
        word = word << 1 | bit
    return word
