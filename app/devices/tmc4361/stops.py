"""Stops, ahead of everything that waits for the link.

Writing VMAX 0 alone is not allowed while an S-ramp is positioning (DS-TMC4361 8.2.2, case 2). So "ramp" writes the
least VMAX that is not 0, which the same section offers for a way out, then velocity mode, then VMAX 0. "immediate" does
the same with velocity mode on hold ramps, in which VACTUAL is VMAX at once (DS-TMC4361 8.2). Should the link fail in
between, the axis is left at a pulse in four minutes: the other order, mode first, would leave it turning at its speed
limit for good.

A START_CONF that makes VMAX or RAMPMODE wait for a start signal would make the stop wait too: its bits go first, and
stay cleared.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import BenchError, LinkDown, LinkTimeout, WriteRefused
from ...links.queue import Priority
from ..core.register_io import RegisterIO, Snapshot, Write
from ..core.register_link import RegisterLink
from ..core.results import StopMode, StopOutcome
from ..core.stop_each import stop_each
from . import prediction, roles
from .cruise import Cruise
from .expected_motion import ExpectedMotion
from .memory import ChipMemory
from .ramp_parameters import RampParameters

STATE = (roles.XACTUAL, roles.VACTUAL, roles.AACTUAL)
GATES = roles.GATE_VMAX.mask | roles.GATE_RAMPMODE.mask


class Stops:
    """Stops the axis of one TMC4361."""

    def __init__(self, link: RegisterLink, memory: ChipMemory, cruise: Cruise, expected: ExpectedMotion) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._cruise = cruise
        self._expected = expected

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        """Stop ahead of everything that waits for this link. Failures are in the outcomes, not raised."""

        async def stop(axis: int) -> BenchError | None:
            del axis  # it has one
            async with self._link.turn(Priority.STOP) as turn:
                return await self._stop(self._link.io(turn), mode)

        return await stop_each(self._session, axes, mode, stop)

    async def _stop(self, io: RegisterIO, mode: StopMode) -> BenchError | None:
        problem: BenchError | None = None
        for attempt in (1, 2):  # a stop moves nothing, so it may be sent again
            try:
                stands = attempt == 1 and await self._read_before_stop(io)
                return await self._send_stop(io, mode, stands=stands)
            except LinkDown as error:
                return error
            except (LinkTimeout, BenchError) as error:
                # The second time nothing is asked before: what was last seen has to do.
                problem = error
        self._expected.uncertain(str(problem))
        return problem

    async def _read_before_stop(self, io: RegisterIO) -> bool:
        """Whether the axis stands; the ramp is read along."""
        asked = (*STATE, *roles.RAMP)
        held = Snapshot(asked, await io.read_many(asked))
        self._memory.saw_all(held)
        return held.word(roles.VACTUAL) == held.word(roles.AACTUAL) == 0

    async def _send_stop(self, io: RegisterIO, mode: StopMode, *, stands: bool) -> BenchError | None:
        ramp = self._memory.ramp()
        at_once = mode == "immediate" or (ramp is not None and ramp.never_slows())
        shape = roles.HOLD if at_once else self._cruise.shape
        slow, to_mode, to_zero = Write(roles.VMAX, 1), Write(roles.RAMPMODE, shape), Write(roles.VMAX, 0)
        gates = 0 if ramp is None else ramp.value(roles.START_CONF) & GATES
        ungate = [Write(roles.START_CONF, ramp.value(roles.START_CONF) & ~GATES)] if ramp and gates else []
        self._cruise.overwrite_mode(shape)
        self._cruise.overwrite_vmax(0)
        checked = (roles.RAMPMODE, roles.VMAX, *STATE)
        order = (to_zero, to_mode) if stands else (slow, to_mode, to_zero)
        held = Snapshot(checked, (await io.chain(*ungate, *order, checked))[0])
        self._expected.watch.stop_commanded(io.time_s)
        if held.value(roles.RAMPMODE) != shape or held.value(roles.VMAX) != 0:
            # One flipped bit on the way back looks like a refused write; a stop may be sent twice.
            held = Snapshot(checked, (await io.chain(*ungate, *order, checked, again=True))[0])
        self._memory.saw_all(held)
        for register, wanted in ((roles.RAMPMODE, shape), (roles.VMAX, 0)):
            if held.value(register) != wanted:
                return WriteRefused(register.name, wanted, held.word(register), "stop again, or cut the power")
        self._expect_stop(io.time_s, ramp, shape, held)
        return None

    def _expect_stop(self, time_s: float, ramp: RampParameters | None, shape: int, held: Snapshot) -> None:
        plan = None
        velocity = held.value(roles.VACTUAL)
        if ramp is not None and velocity:
            plan = prediction.to_velocity(ramp, shape, 0.0, velocity, held.value(roles.AACTUAL))
        self._expected.expect(time_s, held.value(roles.XACTUAL), plan)
