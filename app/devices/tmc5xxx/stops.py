"""Stops, ahead of everything that waits for the link; and setting the position of an axis that stands.

A stop is VMAX 0 and velocity mode, in this order: should the link fail in between, the axis brakes all the same, while
mode first would leave it turning at its speed limit for good. Velocity mode brakes with AMAX, so "ramp" leaves AMAX as
the user has set it, and "immediate" makes it the greatest there is, 65535 (7.6 million pps^2 at 16 MHz): the hardest
stop that takes one write and no knowledge of switches and their polarity. An AMAX of 0 would never brake and counts as
"immediate". Afterwards no target of the past can move the axis; the next move brings VMAX and AMAX back.

Source: TMC5160A data sheet 1.14, 14.2.4, first of the ways to end a ramp early.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

from ...errors import BadReply, BenchError, LinkDown, OutOfRange, WriteRefused, WrongState
from ...links.queue import Priority
from ...registers.model import Register, to_raw
from ..core.register_io import Held, Words, Write
from ..core.results import StopMode, StopOutcome
from ..core.sixpoint_plans import turn_plan
from . import rows as r
from .moves import HIGHEST, LOWEST, Moves

HARDEST = 0xFFFF
"""The greatest AMAX."""


class Stops(Moves):
    """A TMC5xxx that can be stopped."""

    # --- stops ----------------------------------------------------------------------------------

    async def _stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        began = time.perf_counter()
        for axis in axes:
            self.stops[axis] += 1  # before anything waits: what is under way for these axes gives up
            self.commanded(axis, "stop", mode=mode)
        outcomes = []
        for axis in axes:
            async with self.queue.turn(Priority.STOP) as turn:
                problem = await self._stop(self.words(turn), axis, mode)
            outcomes.append(StopOutcome(self.id, axis, problem is None, (time.perf_counter() - began) * 1e3, problem))
        return outcomes

    async def _stop(self, words: Words, axis: int, mode: StopMode) -> BenchError | None:
        problem: BenchError | None = None
        for _ in (1, 2):  # a stop moves nothing, so it may be sent again
            try:
                problem = await self._send_stop(words, axis, mode)
            except LinkDown as error:
                return error
            except BenchError as error:
                problem = error
            if problem is None:
                return None
        self._motion_uncertain(axis, str(problem))
        return problem

    async def _send_stop(self, words: Words, axis: int, mode: StopMode) -> BenchError | None:
        rows = self.rows(axis)
        amax = self.wanted(rows.amax)
        if mode == "immediate" or amax == 0:
            amax = HARDEST
        # AMAX last of all that matters: with VMAX 0 the axis brakes already, and this only makes it brake otherwise.
        braking = [] if amax is None else [Write(rows.amax, amax)]
        writes = [Write(rows.vmax, 0), *braking, Write(rows.rampmode, r.FORWARD)]
        for write in writes[:-1]:
            self._overwrite(write.register, write.word)
        checked = (rows.rampmode, rows.xactual, rows.vactual)
        back = Held(checked, (await words.chain(*writes, checked))[0])
        self._watches[axis].stop_commanded(words.time_s)
        self._saw(back)
        self._saw_positions(back, words.asked_s)
        if not words.arrived:
            return BadReply(self.port.name, "the stop may have arrived otherwise", b"")
        if back.value(rows.rampmode) != r.FORWARD:
            return WriteRefused(rows.rampmode.name, r.FORWARD, back.word(rows.rampmode), "stop again, or cut the power")
        ramp = self.ramp(axis)
        v_pps = back.value(rows.vactual) * ramp.velocity_unit_pps
        plan = turn_plan(ramp.sixpoint(vmax=1, amax=amax), 0.0, v_pps) if v_pps else None
        self._expect(axis, words.time_s, back.value(rows.xactual), plan)
        return None

    # --- setting the position -------------------------------------------------------------------

    async def set_position(self, axis: int, position: int, *, with_encoder: bool = True) -> int:
        """Call the place where the motor stands `position`; XTARGET follows, and an encoder that counts, but for
        `with_encoder` False. Returns the difference.

        The axis is in velocity mode with VMAX 0 afterwards, as after a stop. Raises WrongState while the motor turns,
        OutOfRange outside 32 bits.
        """
        rows = self.rows(self.axis(axis).index)
        if not LOWEST <= position <= HIGHEST:
            raise OutOfRange("position", position, LOWEST, HIGHEST, "microsteps")
        self.require_connected()
        if self.limiter is not None:
            self.limiter.require_target(axis, position)
        # No guard: a stop that comes between changes nothing here, and nothing here sets the motor in motion.
        async with self.queue.turn(Priority.COMMAND) as turn:
            words = self.words(turn)
            encoder = rows.x_enc if self.counts_encoder(axis) else None
            asked = (rows.xactual, rows.vactual, *(() if encoder is None else (encoder,)))
            read = Held(asked, await words.read_many(asked))
            if read.word(rows.vactual):
                raise WrongState(f"axis {axis} moves", "stop it first")
            before = read.value(rows.xactual)
            shift = before - position
            self.commanded(axis, "set_position", position=position)
            steps: list[tuple[Register, int]] = [
                *self._standing_still(axis),
                (rows.xactual, to_raw(position, 32)),
                (rows.xtarget, to_raw(position, 32)),
            ]
            if encoder is not None and with_encoder:
                steps.append((encoder, to_raw(read.value(encoder) - shift, 32)))
            checked = (rows.xactual, rows.xtarget, rows.rampmode)
            back = Held(checked, (await words.chain(*(Write(*step) for step in steps), checked))[0])
            self._saw(back)
            self._books[axis].end(words.time_s, "the position was set")
        for register in (rows.xactual, rows.xtarget):
            if back.value(register) != position:
                raise WriteRefused(
                    register.name, to_raw(position, 32), back.word(register), f"{rows.xactual.name} was {before}"
                )
        self.saw_position(axis, position, words.asked_s)
        return shift

    async def position_from_encoder(self, axis: int) -> int:
        """Call the place where the motor stands what its encoder shows; the difference. Raises WrongState."""
        rows = self.rows(self.axis(axis).index)
        if rows.x_enc is None or not self.counts_encoder(axis):
            raise WrongState("no encoder counts on this axis", "set ENC_CONST first")
        return await self.set_position(axis, (await self.read(rows.x_enc.name, axis)).value, with_encoder=False)

    async def clear_flags(self, axis: int) -> None:
        """Take notice of RAMP_STAT and GSTAT, as reading or writing them does. An axis that a stall holds is kept
        where it is first, so nothing moves."""
        rows = self.rows(self.axis(axis).index)
        self.require_connected()
        async with self.queue.turn() as turn:
            words = self.words(turn)
            if self._stat[axis] & self.flags[axis].stall or not self._may_read_stat(axis):
                await self._stand_still(words, axis)
        for row, where in ((rows.ramp_stat, axis), (self.chip.gstat, None)):
            if row.read_clears:
                await self.read(row.name, where)
            else:
                await self.write(row.name, where, value=(await self.read(row.name, where)).value)
