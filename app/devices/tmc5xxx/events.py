"""GSTAT and RAMP_STAT without losing a flag: told as a timeline, and kept for whoever reads the register by its name.

Of the TMC5031, 5062, 5072 and 5130 a reading clears them, and the driver has to read them: what it took away so is
owed, and added to the next reading by name. Of the TMC5160 they stay until a 1 is written to them; the driver writes
it for what it has told, so that it can see it come again, and owes that until its user writes the 1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ...errors import BenchError
from ...registers.model import Register
from ..core.capabilities import EventLog
from ..core.register_io import Snapshot
from ..core.results import DeviceState, EventPage
from ..core.session import Session
from ..core.timeline import Timeline
from . import roles as r
from .flags import GSTAT_LSB, AxisFlags
from .roles import ChipRoles


class Events(EventLog):
    """What the event registers have told. Asks nothing of the chip.

    on_reset : who has to hear of a reset of the chip, in this order
    """

    def __init__(self, session: Session, chip: ChipRoles, on_reset: Sequence[Callable[[], None]]) -> None:
        self.resets = 0
        """How often a reset of the chip was seen, that of its power-on included where nobody had taken notice of it."""
        self.acquainted = False
        """Whether GSTAT was read since the device is connected: the first reset is that of its power-on."""
        self.reset_s = float("-inf")
        """When the latest reset was seen that was not that of power-on, device time [s]."""
        self.lost = False
        """It was reset while we knew it, and nobody has read GSTAT since."""
        self._session = session
        self._chip = chip
        self._on_reset = tuple(on_reset)
        self._flags = tuple(AxisFlags.of(chip, rows) for rows in chip.axes)
        self._timelines = tuple(Timeline(axis, flags.mask, flags.names_of) for axis, flags in enumerate(self._flags))
        self._owed: dict[int, int] = {}
        """Flags that the driver has cleared, by address, until their user has seen them."""
        self._stat = [0] * len(chip.axes)
        """RAMP_STAT as last seen."""
        self._polled: list[int | None] = [None] * len(chip.axes)
        """RAMP_STAT of the latest poll; None where it has not been read yet, or must not be."""
        self._gstat = 0

    def events(self, axis: int, after: int = 0, limit: int = 1000, /) -> EventPage:
        return self._timelines[self._session.axis(axis).index].page(after, limit)

    # --- what is so -----------------------------------------------------------------------------

    def flags(self, axis: int) -> AxisFlags:
        """Which bits are events of an axis."""
        return self._flags[axis]

    def stalled(self, axis: int) -> bool:
        """Whether a stop by StallGuard holds the axis, by RAMP_STAT as last seen."""
        return bool(self._stat[axis] & self._flags[axis].stall)

    def polled_stat(self, axis: int) -> int | None:
        """RAMP_STAT of the latest poll; None where it has not been read yet, or must not be."""
        return self._polled[axis]

    def to_clear(self, axes: Sequence[int], *, stall: bool) -> list[tuple[Register, int]]:
        """The 1s to write for what was seen and told; that of a stall's stop only with `stall`."""
        writes: list[tuple[Register, int]] = []
        for axis in axes:
            flags = self._flags[axis]
            bits = self._stat[axis] & flags.latching & (flags.mask if stall else ~flags.stall)
            if bits:
                writes.append((self._chip.axes[axis].ramp_stat, bits))
        reset = r.part(self._chip.gstat, "reset").mask
        if self._gstat & reset:
            writes.append((self._chip.gstat, reset))
        return writes

    # --- telling --------------------------------------------------------------------------------

    def saw(self, held: Snapshot, time_s: float) -> None:
        """GSTAT, and RAMP_STAT of some axes, were read at `time_s` [s]."""
        clears = self._chip.clears_on_read
        gstat = held.word(self._chip.gstat) & self._chip.gstat.mask
        self._gstat = gstat
        if clears and gstat:
            self.cleared(self._chip.gstat, gstat)
        if gstat & r.part(self._chip.gstat, "reset").mask:
            self._was_reset()
        self.acquainted = True
        for rows in self._chip.axes:
            flags = self._flags[rows.axis]
            word, mask = gstat << GSTAT_LSB, flags.mask & ~0xFFFF
            if rows.ramp_stat.address in held.words:
                stat = held.word(rows.ramp_stat) & rows.ramp_stat.mask
                self._stat[rows.axis] = self._polled[rows.axis] = stat
                word, mask = word | stat, flags.mask
                if clears and stat & flags.latching:
                    self.cleared(rows.ramp_stat, stat & flags.latching)
            left = word & ~flags.latching if clears else word
            self._tell(rows.axis, word, left, time_s, mask)

    def left_out(self, axis: int) -> None:
        """RAMP_STAT of this axis must not be read now."""
        self._polled[axis] = None

    def cleared(self, register: Register, bits: int) -> None:
        """The driver has cleared these flags."""
        self._owed[register.address] = self._owed.get(register.address, 0) | bits
        if self._chip.clears_on_read:
            return
        for axis, rows in enumerate(self._chip.axes):
            if register is rows.ramp_stat:
                self._stat[axis] &= ~bits
                self._timelines[axis].cleared(bits)
            elif register is self._chip.gstat:
                self._timelines[axis].cleared(bits << GSTAT_LSB)
        if register is self._chip.gstat:
            self._gstat &= ~bits

    def _tell(self, axis: int, word: int, left: int, time_s: float, mask: int) -> None:
        entry = self._timelines[axis].read(word, left, time_s, mask)
        if entry is not None:
            self._session.tell(entry)

    def _was_reset(self) -> None:
        """GSTAT tells of a reset that was not told yet."""
        self.resets += 1
        self.lost = self.acquainted
        if self.acquainted:
            self.reset_s = self._session.device_time_s()
        for hear in self._on_reset:
            hear()

    # --- by hand --------------------------------------------------------------------------------

    def read_by_hand(self, register: Register, word: int, time_s: float) -> None:
        """A caller has read a register that reading clears: the events are told all the same."""
        if register is self._chip.gstat:
            self.saw(Snapshot((register,), (word,)), time_s)
        for axis, rows in enumerate(self._chip.axes):
            if register is rows.ramp_stat:
                flags = self._flags[axis]
                self._stat[axis] = word & register.mask
                self._tell(axis, word, word & ~flags.latching, time_s, flags.mask & 0xFFFF)

    def shown(self, register: Register, word: int) -> int:
        """`word` with what the driver has cleared of it."""
        owed = self._owed.get(register.address, 0)
        return word | owed if owed and register.access.readable else word

    def delivered(self, register: Register) -> None:
        """Its user gets what is owed."""
        if register.read_clears:
            self._owed.pop(register.address, None)
        if register is self._chip.gstat:
            self.lost = False

    def sent(self, register: Register, word: int) -> None:
        """Its user has written the 1s of `word`."""
        if register.address in self._owed and not register.read_clears:
            self._owed[register.address] &= ~word

    def heard_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """The connection is in this state."""
        del problem
        if state == "failed":
            self._stat = [0] * len(self._stat)
            self._polled = [None] * len(self._polled)
            self._gstat = 0
            for timeline in self._timelines:
                timeline.forget()
