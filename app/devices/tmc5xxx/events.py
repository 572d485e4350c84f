"""GSTAT and RAMP_STAT without losing a flag: told as a timeline, and kept for whoever reads the register by its name.

Of the TMC5031, 5062, 5072 and 5130 a reading clears them, and the driver has to read them: what it took away so is
owed, and added to the next reading by name. Of the TMC5160 they stay until a 1 is written to them; the driver writes
it for what it has told, so that it can see it come again, and owes that until its user writes the 1.

A stop by StallGuard is the exception. Clearing its flag lets the motor go on, so no look clears it: where reading would
(`_may_read_stat`), RAMP_STAT is not read while a motor with SW_MODE.sg_stop set has somewhere to go.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...clock import Clock
from ...errors import BenchError
from ...links.port import FramePort
from ...registers.model import Register
from ..core.config import DeviceConfig
from ..core.register_io import Held, Words
from ..core.results import DeviceState, EventPage
from ..core.timeline import Timeline
from . import rows as r
from .chip import Chip
from .flags import GSTAT_LSB, AxisFlags

STATUS_RESET = 1
"""reset_flag in the SPI status byte."""


class Events(Chip):
    """A TMC5xxx whose events are kept."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self.flags = tuple(AxisFlags.of(self.chip, rows) for rows in self.chip.axes)
        self._timelines = tuple(Timeline(axis, flags.mask, flags.names_of) for axis, flags in enumerate(self.flags))
        self._owed: dict[int, int] = {}
        """Flags that the driver has cleared, by address, until their user has seen them."""
        self._stat = [0] * len(self.axes)
        """RAMP_STAT as last seen."""
        self._looked: list[int | None] = [None] * len(self.axes)
        """RAMP_STAT of the latest look; None where it has not been read yet, or must not be."""
        self._gstat = 0
        self.resets = 0
        """How often a reset of the chip was seen, that of its power-on included where nobody had taken notice of it."""
        self._acquainted = False
        """Whether GSTAT was read since the device is connected: the first reset is that of its power-on."""
        self._reset_s = float("-inf")
        """When the latest reset was seen that was not that of power-on, device time [s]."""
        self._lost = False
        """It was reset while we knew it, and nobody has read GSTAT since."""

    def events(self, axis: int, after: int = 0, limit: int = 1000) -> EventPage:
        """The oldest `limit` entries of the timeline behind number `after`. Raises UnknownThing for the axis."""
        return self._timelines[self.axis(axis).index].page(after, limit)

    # --- reading --------------------------------------------------------------------------------

    async def _peek(self, words: Words, axes: Sequence[int], registers: Sequence[Register] = ()) -> Held:
        """`registers`, SW_MODE and GSTAT, and RAMP_STAT of these axes where it may be read; what is new is told.

        The flags are asked last: none that came with a change of the others can be missing.
        """
        asked = list({row.address: row for row in (*registers, *(self.rows(axis).sw_mode for axis in axes))}.values())
        stats = []
        for axis in axes:
            if self._may_read_stat(axis):
                stats.append(self.rows(axis).ramp_stat)
            else:
                self._looked[axis] = None
        asked += [*stats, self.chip.gstat]
        held = Held(asked, await words.read_many(asked))
        asked_at_s, time_s = words.asked_s, words.time_s
        if self._tells_reset(held) and words.first_status is not None and await self._was_noise(words):
            held.words[self.chip.gstat.address] &= ~r.part(self.chip.gstat, "reset").mask
        self._saw_flags(held, time_s)  # first: a reset makes forget what was seen before
        self._saw(held)
        self._saw_positions(held, asked_at_s)
        return held

    def _tells_reset(self, held: Held) -> bool:
        """Whether GSTAT tells of a reset of a chip that we know."""
        return self._acquainted and bool(self.chip.gstat.unpack(held.word(self.chip.gstat))["reset"])

    async def _was_noise(self, words: Words) -> bool:
        """Whether a reset in GSTAT was a bit flipped on the way, for SPI has no CRC: the status byte at the beginning
        of the chain knew of none, and the chip holds what it would not after one."""
        known = [row for row in self.chip.remembered if self.known(row) not in (None, row.reset)]
        if (words.first_status or 0) & STATUS_RESET or not known:
            return False
        again = await words.read_many(known)
        return any(word & row.mask == self.known(row) for row, word in zip(known, again, strict=True))

    async def _look_at_events(self, words: Words, axes: Sequence[int], registers: Sequence[Register] = ()) -> Held:
        """`_peek`, and clear what was told and may be cleared, where that takes a write."""
        held = await self._peek(words, axes, registers)
        if not self.chip.clears_on_read:
            await self._clear(words, axes, stall=False)
        return held

    async def _clear(self, words: Words, axes: Sequence[int], *, stall: bool) -> None:
        """Write 1 to the flags that were seen, that of a stall's stop only with `stall`."""
        writes: list[tuple[Register, int]] = []
        for axis in axes:
            flags = self.flags[axis]
            bits = self._stat[axis] & flags.latching & (flags.mask if stall else ~flags.stall)
            if bits:
                writes.append((self.rows(axis).ramp_stat, bits))
        reset = r.part(self.chip.gstat, "reset").mask
        if self._gstat & reset:
            writes.append((self.chip.gstat, reset))
        if not writes:
            return
        await words.write_many(writes)
        for register, bits in writes:
            self._took(register, bits)

    def _may_read_stat(self, axis: int) -> bool:
        """Whether reading RAMP_STAT can set nothing off."""
        if not self.chip.clears_on_read:
            return True
        rows = self.rows(axis)
        sw_mode = self.known(rows.sw_mode)
        if sw_mode is None:
            return False
        return not r.part(rows.sw_mode, "sg_stop").unpack(sw_mode) or self._goes_nowhere(axis)

    def _goes_nowhere(self, axis: int) -> bool:
        """Whether the axis would stay where it is if nothing held it."""
        raise NotImplementedError

    def _saw_positions(self, held: Held, asked_at_s: float) -> None:
        """Tell of the position counters that were among what was read."""
        for rows in self.chip.axes:
            if rows.xactual.address in held.words:
                encoder = rows.x_enc if self.counts_encoder(rows.axis) else None
                seen = None if encoder is None or encoder.address not in held.words else held.value(encoder)
                self.saw_position(rows.axis, held.value(rows.xactual), asked_at_s, seen)

    # --- telling --------------------------------------------------------------------------------

    def _saw_flags(self, held: Held, time_s: float) -> None:
        """GSTAT, and RAMP_STAT of some axes, were read at `time_s` [s]."""
        clears = self.chip.clears_on_read
        gstat = held.word(self.chip.gstat) & self.chip.gstat.mask
        self._gstat = gstat
        if clears and gstat:
            self._took(self.chip.gstat, gstat)
        fresh = bool(gstat & r.part(self.chip.gstat, "reset").mask)
        if fresh:
            self._was_reset()
        self._acquainted = True
        for rows in self.chip.axes:
            flags = self.flags[rows.axis]
            word, mask = gstat << GSTAT_LSB, flags.mask & ~0xFFFF
            if rows.ramp_stat.address in held.words:
                stat = held.word(rows.ramp_stat) & rows.ramp_stat.mask
                self._stat[rows.axis] = self._looked[rows.axis] = stat
                word, mask = word | stat, flags.mask
                if clears and stat & flags.latching:
                    self._took(rows.ramp_stat, stat & flags.latching)
            left = word & ~flags.latching if clears else word
            self._tell_events(rows.axis, word, left, time_s, mask)

    def _tell_events(self, axis: int, word: int, left: int, time_s: float, mask: int) -> None:
        entry = self._timelines[axis].read(word, left, time_s, mask)
        if entry is not None:
            self._tell(entry)

    def _took(self, register: Register, bits: int) -> None:
        """The driver has cleared these flags."""
        self._owed[register.address] = self._owed.get(register.address, 0) | bits
        if self.chip.clears_on_read:
            return
        for axis, rows in enumerate(self.chip.axes):
            if register is rows.ramp_stat:
                self._stat[axis] &= ~bits
                self._timelines[axis].cleared(bits)
            elif register is self.chip.gstat:
                self._timelines[axis].cleared(bits << GSTAT_LSB)
        if register is self.chip.gstat:
            self._gstat &= ~bits

    def _was_reset(self) -> None:
        """GSTAT tells of a reset that was not told yet."""
        self.resets += 1
        self._lost = self._acquainted
        if self._acquainted:
            self._reset_s = self.device_time_s()
        self._forget_setting()

    # --- by hand --------------------------------------------------------------------------------

    async def _read_alone(self, register: Register) -> int:
        if not register.read_clears:
            return await super()._read_alone(register)
        # Somebody wants to read it, and so to clear it. Never asked twice: the answer may be all that was lost.
        async with self.queue.turn() as turn:
            replies = await turn.exchange_many(self.access.read_frames((register.address,)))
            word = self.access.words(replies)[0]
            self._read_by_hand(register, word, turn.last_exchange_s)
        return word

    def _read_by_hand(self, register: Register, word: int, time_s: float) -> None:
        """Somebody has read a register that reading clears: the events are told all the same."""
        if register is self.chip.gstat:
            self._saw_flags(Held((register,), (word,)), time_s)
        for axis, rows in enumerate(self.chip.axes):
            if register is rows.ramp_stat:
                flags = self.flags[axis]
                self._stat[axis] = word & register.mask
                self._tell_events(axis, word, word & ~flags.latching, time_s, flags.mask & 0xFFFF)

    def _shown(self, register: Register, word: int) -> int:
        owed = self._owed.get(register.address, 0)
        return word | owed if owed and register.access.readable else word

    def _delivered(self, register: Register) -> None:
        if register.read_clears:
            self._owed.pop(register.address, None)
        if register is self.chip.gstat:
            self._lost = False

    def _sent(self, register: Register, word: int) -> None:
        super()._sent(register, word)
        if register.address in self._owed and not register.read_clears:
            self._owed[register.address] &= ~word

    def set_state(self, state: DeviceState, problem: BenchError | None = None) -> None:
        super().set_state(state, problem)
        if state == "failed":
            self._stat = [0] * len(self.axes)
            self._looked = [None] * len(self.axes)
            self._gstat = 0
            for timeline in self._timelines:
                timeline.forget()
