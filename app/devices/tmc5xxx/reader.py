"""Reads the chip's state together with its event flags, so that no flag is lost and nothing is set off.

A stop by StallGuard is the exception among the flags. Clearing its flag lets the motor go on, so no poll clears it:
where reading would (`may_read_stat`), RAMP_STAT is not read while a motor with SW_MODE.sg_stop set has somewhere to go.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...registers.model import Register
from ..core.register_io import RegisterIO, Snapshot
from ..core.register_link import RegisterLink
from . import roles as r
from .decoded_registers import DecodedRegisters
from .events import Events
from .memory import ChipMemory

STATUS_RESET = 1
"""reset_flag in the SPI status byte."""


class ChipReader:
    """Registers and flags in one chain, the flags last; whoever keeps something in mind is told."""

    def __init__(self, link: RegisterLink, memory: ChipMemory, decoded: DecodedRegisters, log: Events) -> None:
        self._link = link
        self._memory = memory
        self._decoded = decoded
        self._log = log

    async def peek(self, io: RegisterIO, axes: Sequence[int], registers: Sequence[Register] = ()) -> Snapshot:
        """`registers`, SW_MODE and GSTAT, and RAMP_STAT of these axes where it may be read; what is new is told.

        The flags are asked last: none that came with a change of the others can be missing.
        """
        memory, gstat = self._memory, self._memory.chip.gstat
        asked = list({row.address: row for row in (*registers, *(memory.rows(axis).sw_mode for axis in axes))}.values())
        stats = []
        for axis in axes:
            if self.may_read_stat(axis):
                stats.append(memory.rows(axis).ramp_stat)
            else:
                self._log.left_out(axis)
        asked += [*stats, gstat]
        held = Snapshot(asked, await io.read_many(asked))
        asked_at_s, time_s = io.asked_s, io.time_s
        if self._tells_reset(held) and io.first_status is not None and await self._was_noise(io):
            held.words[gstat.address] &= ~r.part(gstat, "reset").mask
        self._log.saw(held, time_s)  # first: a reset makes forget what was seen before
        memory.saw(held)
        self._decoded.tell_positions(held, asked_at_s)
        return held

    async def poll(self, io: RegisterIO, axes: Sequence[int], registers: Sequence[Register] = ()) -> Snapshot:
        """`peek`, and clear what was told and may be cleared, where that takes a write."""
        held = await self.peek(io, axes, registers)
        if not self._memory.chip.clears_on_read:
            await self.clear(io, axes, stall=False)
        return held

    async def clear(self, io: RegisterIO, axes: Sequence[int], *, stall: bool) -> None:
        """Write 1 to the flags that were seen, that of a stall's stop only with `stall`."""
        writes = self._log.to_clear(axes, stall=stall)
        if not writes:
            return
        await io.write_many(writes)
        for register, bits in writes:
            self._log.cleared(register, bits)

    def may_read_stat(self, axis: int) -> bool:
        """Whether reading RAMP_STAT can set nothing off."""
        if not self._memory.chip.clears_on_read:
            return True
        sw_mode_row = self._memory.rows(axis).sw_mode
        sw_mode = self._memory.known(sw_mode_row)
        if sw_mode is None:
            return False
        return not r.part(sw_mode_row, "sg_stop").unpack(sw_mode) or self._decoded.goes_nowhere(axis)

    async def read_alone(self, register: Register) -> int | None:
        """A register that reading clears, for a caller that wants that; None for all others."""
        if not register.read_clears:
            return None
        # Never asked twice: the answer may be all that was lost.
        async with self._link.session.queue.turn() as turn:
            replies = await turn.exchange_many(self._link.access.read_frames((register.address,)))
            word = self._link.access.words(replies)[0]
            self._log.read_by_hand(register, word, turn.last_exchange_s)
        return word

    def _tells_reset(self, held: Snapshot) -> bool:
        """Whether GSTAT tells of a reset of a chip that we know."""
        gstat = self._memory.chip.gstat
        return self._log.acquainted and bool(gstat.unpack(held.word(gstat))["reset"])

    async def _was_noise(self, io: RegisterIO) -> bool:
        """Whether a reset in GSTAT was a bit flipped on the way, for SPI has no CRC: the status byte at the beginning
        of the chain knew of none, and the chip holds what it would not after one."""
        memory = self._memory
        known = [row for row in memory.chip.remembered if memory.known(row) not in (None, row.reset)]
        if (io.first_status or 0) & STATUS_RESET or not known:
            return False
        again = await io.read_many(known)
        return any(word & row.mask == memory.known(row) for row, word in zip(known, again, strict=True))
