"""Interrupt flags as a timeline: what each axis was told by its flags, when, and each time anew.

A flag stays set until a 1 is written to it (DS-TMC428 8.13), so it could be seen to come only once. The driver writes
the 1 for what it has told, and shows the flag to whoever reads the register by name until its user has written the 1.
A flag whose mask is off stays 0: nothing is told, and nothing is written, before its user wants interrupts.

INT, bit 7 of every status byte, says that some flag of some axis is set. Samples bring it for nothing, so an event
bears the time of the first sample that showed it; the flags themselves are then read at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import BenchError
from ...registers.model import Access, Register
from ...registers.tmcdrivers import tmc236, tmc2660
from ..core.background_tasks import BackgroundTasks
from ..core.capabilities import EventLog
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from ..core.results import DeviceState, EventPage
from ..core.sample_plan import FloatArray, IntArray
from ..core.timeline import Timeline
from .axis_roles import AxisRoles

INT = 1 << 7
"""In the status byte (DS-TMC428 Table 6-4; DS-TMC4210 5.2.2.2)."""
MASK_LSB = 8
"""The mask of a flag stands eight bits above it, in the registers of axes and of the position compare alike."""
COMPARE_BIT = 8
"""Of the words of a timeline: behind the eight flags of the axis."""
COMPARE_EVENT = "POS_COMP"
OWN = 0x1FF
DRIVER_LSB = 9
DRIVER_FLAGS = tuple(dict.fromkeys((*tmc2660.FLAGS[:-1], *tmc236.FLAGS)))
DRIVER = (1 << len(DRIVER_FLAGS)) - 1 << DRIVER_LSB
"""Of the words of a timeline: flags of the axis and of the compare, and behind them those of its driver on the chain,
whichever it is; not that the motor stands."""


@dataclass(frozen=True, slots=True)
class Compare:
    """The flag of the position compare, and the axis that is compared; None for none."""

    register: Register
    axis: Callable[[], int | None]


class Interrupts(EventLog):
    """The interrupt flags of all axes. `tasks` end with the driver."""

    def __init__(
        self, link: RegisterLink, rows: Sequence[AxisRoles], compare: Compare | None, tasks: BackgroundTasks
    ) -> None:
        self._link = link
        self._session = link.session
        self._registers = [one.interrupts for one in rows]
        self._compare = compare
        self._tasks = tasks
        names = [_flag_names(register) for register in self._registers]
        self._timelines = [Timeline(axis, OWN | DRIVER, _named(each)) for axis, each in enumerate(names)]
        self._owed: dict[int, int] = {}
        """Flags that the driver has cleared, by address, until their user has written the 1."""
        self._high = False
        """INT in the latest sample."""
        self._risen_s: float | None = None
        """The sample in which INT rose, until all flags were read."""
        self._cleared_s = float("-inf")
        """When flags were cleared last, device time [s]: later samples with INT show others."""
        self._session.state_hooks.append(self._heard_state)

    def events(self, axis: int, after: int = 0, limit: int = 1000, /) -> EventPage:
        return self._timelines[self._session.axis(axis).index].page(after, limit)

    # --- reading --------------------------------------------------------------------------------

    async def look(self, io: RegisterIO, axis: int) -> int:
        """The interrupt word of an axis, as its user is to see it; what is new is told, and cleared in the chip.

        Where its position is compared, the flag of that is looked at as well.
        """
        register = self._registers[axis]
        word = await io.read(register)
        compare = self._compare if self._compare is not None and self._compare.axis() == axis else None
        compared = 0 if compare is None else await io.read(compare.register)
        shown = self.shown(register, word)
        flags = word & 0xFF | (compared & 1) << COMPARE_BIT
        entry = self._timelines[axis].read(flags, 0, io.time_s if self._risen_s is None else self._risen_s, OWN)
        if word & 0xFF:
            await self._clear(io, register, word, word & 0xFF)
        if compare is not None and compared & 1:
            await self._clear(io, compare.register, compared, 1)
        if entry is not None:
            self._session.tell(entry)
        return shown | word & 0xFF

    def driver_told(self, axis: int, flags: Mapping[str, bool], time_s: float) -> None:
        """The driver of an axis on the chain has told these flags of itself: what has come is an event."""
        word = sum(1 << DRIVER_LSB + bit for bit, name in enumerate(DRIVER_FLAGS) if flags.get(name))
        entry = self._timelines[axis].read(word, word, time_s, DRIVER)
        if entry is not None:
            self._session.tell(entry)

    async def _clear(self, io: RegisterIO, register: Register, word: int, flags: int) -> None:
        """Write 1s to these flags and leave the masks as they are. Owed first: the write may arrive without a reply."""
        self._owed[register.address] = self._owed.get(register.address, 0) | flags
        await io.write(register, word & ~0xFF | flags)
        self._cleared_s = io.time_s

    # --- samples --------------------------------------------------------------------------------

    def saw_rows(self, times_s: FloatArray, words: IntArray, status: IntArray) -> None:
        """A block of samples with their status bytes."""
        del words
        if not len(status):
            return
        high = status & INT != 0
        before = np.concatenate(([self._high], high[:-1]))
        # what was high before flags were cleared, and is high behind that, has risen between
        earlier = np.concatenate(([-np.inf], times_s[:-1]))
        new = high & (~before | (earlier <= self._cleared_s)) & (times_s > self._cleared_s)
        self._high = bool(high[-1])
        rows = np.flatnonzero(new)
        if rows.size and self._risen_s is None:
            self._risen_s = float(times_s[rows[0]])
            self._tasks.begin(self._look_everywhere(), f"reads the interrupt flags of {self._session.id}")

    async def _look_everywhere(self) -> None:
        try:
            async with self._link.turn() as turn:
                io = self._link.io(turn)
                for axis in range(len(self._registers)):
                    await self.look(io, axis)
        except BenchError:
            self._high = False  # asked again with the next sample that shows INT, or with the next poll
        finally:
            self._risen_s = None

    # --- whoever reads and writes by name -------------------------------------------------------

    def shown(self, register: Register, word: int) -> int:
        """`word` with the flags that the driver has cleared of it, as far as their masks are still on."""
        owed = self._owed.get(register.address, 0)
        if not owed:
            return word
        owed &= word >> MASK_LSB & 0xFF
        self._owed[register.address] = owed
        return word | owed

    def sent(self, register: Register, word: int) -> None:
        """Its user has written `word`: 1s to flags, and masks."""
        if register.address in self._owed:
            self._owed[register.address] &= ~word & word >> MASK_LSB & 0xFF

    def _heard_state(self, state: DeviceState, problem: BenchError | None) -> None:
        del problem
        if state != "failed":
            return
        self._owed.clear()
        self._high = False
        self._cleared_s = float("-inf")
        for timeline in self._timelines:
            timeline.forget()


def _flag_names(register: Register) -> dict[int, str]:
    """Names of the flags by their bits."""
    flags = {part.lsb: part.name for part in register.fields if part.access is Access.R_W1C}
    driver = {DRIVER_LSB + bit: f"driver_{name}" for bit, name in enumerate(DRIVER_FLAGS)}
    return {**flags, COMPARE_BIT: COMPARE_EVENT, **driver}


def _named(names: dict[int, str]) -> Callable[[int], tuple[str, ...]]:
    return lambda bits: tuple(name for bit, name in names.items() if bits >> bit & 1)
