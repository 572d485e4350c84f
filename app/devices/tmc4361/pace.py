"""Moves on a trapezoid of a speed and acceleration of their own: what to write, and the ramp that comes of it."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import CannotMove, OutOfRange, WrongState
from ..core.capabilities import LinePace, Registers
from ..core.pace import PacedLeg, PaceLimits
from ..core.register_io import Snapshot
from ..core.register_link import RegisterLink
from ..core.results import WriteItem
from . import prediction, roles
from .cruise import Cruise
from .ramp_parameters import RampParameters

_SPEED_STEPS = 256
_OFF = (roles.VSTART, roles.VSTOP, roles.VBREAK)
_BORROWED = (roles.AMAX, roles.DMAX, *_OFF)


@dataclass(frozen=True, slots=True)
class _Before:
    """Registers by name, speed [1/256 pps] and shape of the user's ramp."""

    words: dict[str, int]
    speed: int
    shape: int


class Pace(LinePace):
    """Of the one axis of a TMC4361."""

    def __init__(self, link: RegisterLink, registers: Registers, cruise: Cruise) -> None:
        self._registers = registers
        self._link = link
        self._session = link.session
        self._cruise = cruise
        self._words: dict[int, int] = {}
        self._seen: _Before | None = None
        self._before: _Before | None = None
        """The user's ramp, while another one is in its place."""

    async def pace_limits(self, axis: int, /) -> PaceLimits:
        async with self._link.command(self._session.axis(axis).index) as turn:
            asked = (*roles.RAMP, roles.XACTUAL, roles.VACTUAL)
            held = Snapshot(asked, await self._link.io(turn).read_many(asked))
        if held.word(roles.VACTUAL):
            raise WrongState(f"axis {axis} of {self._session.name} moves", "stop it first")
        ramp, speed = RampParameters(held.words), self._cruise.speed
        acceleration = min(ramp.pps(roles.AMAX), ramp.pps(roles.DMAX))
        if speed == 0 or acceleration == 0:
            raise CannotMove("the axis cannot move: VMAX, AMAX or DMAX is 0", "write them", axis)
        self._words = dict(held.words)
        words = {row.name: held.value(row) for row in _BORROWED}
        self._seen = _Before(words, speed, self._cruise.shape)
        return PaceLimits(held.value(roles.XACTUAL), speed / _SPEED_STEPS, acceleration)

    def pace_begin(self, axis: int, /) -> None:
        del axis
        self._before = self._before or self._seen

    def paced(self, axis: int, way: int, velocity_pps: float, acceleration_pps2: float, /) -> PacedLeg:
        ramp = RampParameters(self._words)
        try:
            slope = ramp.units.to_raw("AMAX", acceleration_pps2)
        except ValueError as error:
            raise OutOfRange("acceleration", acceleration_pps2, None, None, f"pps^2; {error}") from error
        speed = round(velocity_pps * _SPEED_STEPS)
        if speed < 1:
            raise OutOfRange("velocity", velocity_pps, 1 / _SPEED_STEPS, None, "pps")
        words = {"RAMPMODE": roles.POSITIONING_BIT | roles.TRAPEZOID, "AMAX": slope, "DMAX": slope, "VMAX": speed}
        words |= {row.name: 0 for row in _OFF}
        held = self._words | {roles.row(name).address: word for name, word in words.items()}
        plan = prediction.to_position(RampParameters(held), roles.TRAPEZOID, speed / _SPEED_STEPS, way, 0.0, 0.0)
        if plan is None:
            raise OutOfRange("velocity", velocity_pps, None, None, "pps make no ramp with that acceleration")
        items = tuple(WriteItem(name, axis, word) for name, word in words.items())
        return PacedLeg(items, speed / _SPEED_STEPS, ramp.units.from_raw("AMAX", slope), plan)

    async def pace_back(self, axis: int, /) -> None:
        if self._before is None:
            return
        async with self._link.turn() as turn:
            asked = (roles.RAMPMODE, roles.XTARGET, roles.XACTUAL, roles.VACTUAL)
            held = Snapshot(asked, await self._link.io(turn).read_many(asked))
        if held.word(roles.VACTUAL):
            raise WrongState(f"axis {axis} of {self._session.name} moves", "stop it, and write its ramp again")
        before, self._before = self._before, None
        writes = [WriteItem(name, axis, word) for name, word in before.words.items()]
        positioning = held.word(roles.RAMPMODE) & roles.POSITIONING_BIT
        if positioning and held.word(roles.XTARGET) == held.word(roles.XACTUAL):
            mode = roles.POSITIONING_BIT | before.shape
            writes += [WriteItem("VMAX", axis, before.speed), WriteItem("RAMPMODE", axis, mode)]
        else:  # after a stop: in velocity mode VMAX alone would turn it
            self._cruise.speed, self._cruise.shape = before.speed, before.shape
        done = await self._registers.write_many(writes)
        if done.failed is not None:
            raise done.failed
