"""Stops, ahead of everything that waits for the link.

A stop is VMAX 0 and velocity mode, in this order: should the link fail in between, the axis brakes all the same, while
mode first would leave it turning at its speed limit for good. Velocity mode brakes with AMAX, so "ramp" leaves AMAX as
the user has set it, and "immediate" makes it the greatest there is, 65535 (7.6 million pps^2 at 16 MHz): the hardest
stop that takes one write and no knowledge of switches and their polarity. An AMAX of 0 would never brake and counts as
"immediate". Afterwards no target of the past can move the axis; the next move brings VMAX and AMAX back.

Source: TMC5160A data sheet 1.14, 14.2.4, first of the ways to end a ramp early.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...errors import BadReply, BenchError, LinkDown, WriteRefused
from ...links.queue import Priority
from ..core.register_io import RegisterIO, Snapshot, Write
from ..core.register_link import RegisterLink
from ..core.results import StopMode, StopOutcome
from ..core.session import Session
from ..core.sixpoint_plans import turn_plan
from ..core.stop_each import stop_each
from . import roles as r
from .decoded_registers import DecodedRegisters
from .memory import ChipMemory
from .motions import Motions
from .predictions import Predictions

HARDEST = 0xFFFF
"""The greatest AMAX."""


@dataclass(frozen=True, slots=True)
class Stops:
    """Stops axes."""

    session: Session
    link: RegisterLink
    memory: ChipMemory
    decoded: DecodedRegisters
    predictions: Predictions
    motions: Motions

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        async def stop(axis: int) -> BenchError | None:
            async with self.session.queue.turn(Priority.STOP) as turn:
                return await self._stop(self.link.io(turn), axis, mode)

        return await stop_each(self.session, axes, mode, stop)

    async def _stop(self, io: RegisterIO, axis: int, mode: StopMode) -> BenchError | None:
        problem: BenchError | None = None
        for _ in (1, 2):  # a stop moves nothing, so it may be sent again
            try:
                problem = await self._send_stop(io, axis, mode)
            except LinkDown as error:
                return error
            except BenchError as error:
                problem = error
            if problem is None:
                return None
        self.motions.uncertain(axis, str(problem))
        return problem

    async def _send_stop(self, io: RegisterIO, axis: int, mode: StopMode) -> BenchError | None:
        rows = self.memory.rows(axis)
        amax = self.memory.wanted(rows.amax)
        if mode == "immediate" or amax == 0:
            amax = HARDEST
        # AMAX last of all that matters: with VMAX 0 the axis brakes already, and this only makes it brake otherwise.
        braking = [] if amax is None else [Write(rows.amax, amax)]
        writes = [Write(rows.vmax, 0), *braking, Write(rows.rampmode, r.FORWARD)]
        for write in writes[:-1]:
            self.memory.overwrite(write.register, write.word)
        checked = (rows.rampmode, rows.xactual, rows.vactual)
        back = Snapshot(checked, (await io.chain(*writes, checked))[0])
        self.motions.of(axis).stop_commanded(io.time_s)
        self.memory.saw(back)
        self.decoded.tell_positions(back, io.asked_s)
        if not io.arrived:
            return BadReply(self.session.port.name, "the stop may have arrived otherwise", b"")
        if back.value(rows.rampmode) != r.FORWARD:
            return WriteRefused(rows.rampmode.name, r.FORWARD, back.word(rows.rampmode), "stop again, or cut the power")
        ramp = self.decoded.ramp(axis)
        v_pps = back.value(rows.vactual) * ramp.velocity_unit_pps
        plan = turn_plan(ramp.sixpoint(vmax=1, amax=amax), 0.0, v_pps) if v_pps else None
        self.predictions.expect(axis, io.time_s, back.value(rows.xactual), plan)
        return None
