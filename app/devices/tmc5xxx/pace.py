"""Moves on a trapezoid of a speed and acceleration of their own: V1 0 leaves the other corners of the ramp out."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...calc.units.tmc5xxx import acceleration_unit_pps2, velocity_unit_pps
from ...errors import CannotMove, OutOfRange, WrongState
from ..core.capabilities import LinePace, Registers
from ..core.pace import PacedLeg, PaceLimits
from ..core.register_link import RegisterLink
from ..core.results import WriteItem
from ..core.session import Session
from ..core.sixpoint_plans import move_plan
from . import roles as r
from .decoded_registers import DecodedRegisters
from .memory import ChipMemory
from .ramp import Ramp

ACCELERATION_MAX = (1 << 16) - 1
VSTOP = 10
"""The least that the sheet advises for positioning (DS-TMC5160 12.1: VSTOP)."""
_OFF = {"V1": 0, "VSTART": 0, "VSTOP": VSTOP, "TZEROWAIT": 0}
_FURTHER_OFF = {"V2": 0, "TVMAX": 0}


@dataclass(eq=False)
class Pace(LinePace):
    """Of the axes of one chip."""

    session: Session
    link: RegisterLink
    memory: ChipMemory
    decoded: DecodedRegisters
    registers: Registers
    _held: dict[int, dict[str, int]] = field(default_factory=dict)
    _before: dict[int, dict[str, int]] = field(default_factory=dict)
    """The user's ramps, while others are in their places."""

    async def pace_limits(self, axis: int, /) -> PaceLimits:
        rows = self.memory.rows(self.session.axis(axis).index)
        async with self.link.command(axis) as turn:
            position, velocity = await self.link.io(turn).values((rows.xactual, rows.vactual))
        if velocity:
            raise WrongState(f"axis {axis} of {self.session.name} moves", "stop it first")
        ramp = self.decoded.ramp(axis)
        words = {name: word for name, word in ramp.words.items() if word is not None}
        if len(words) < len(ramp.words):
            unknown = ", ".join(name for name in ramp.words if name not in words)
            raise CannotMove(f"{unknown} cannot be read, and nobody here has written them", "write them", axis)
        ramp.require_move(axis)
        self._held[axis] = words
        clock_hz = self.session.clock_hz
        slope = min(words["AMAX"], words["DMAX"])
        return PaceLimits(
            position, words["VMAX"] * velocity_unit_pps(clock_hz), slope * acceleration_unit_pps2(clock_hz)
        )

    def pace_begin(self, axis: int, /) -> None:
        self._before.setdefault(axis, self._held[axis])

    def paced(self, axis: int, way: int, velocity_pps: float, acceleration_pps2: float, /) -> PacedLeg:
        clock_hz, held = self.session.clock_hz, self._held[axis]
        speed_unit, slope_unit = velocity_unit_pps(clock_hz), acceleration_unit_pps2(clock_hz)
        speed, slope = round(velocity_pps / speed_unit), round(acceleration_pps2 / slope_unit)
        if speed <= VSTOP:
            raise OutOfRange("velocity", velocity_pps, (VSTOP + 1) * speed_unit, None, "pps")
        if not 1 <= slope <= ACCELERATION_MAX:
            raise OutOfRange("acceleration", acceleration_pps2, slope_unit, ACCELERATION_MAX * slope_unit, "pps^2")
        words = {**_OFF, "VMAX": speed, "AMAX": slope, "DMAX": slope}
        if "V2" in held:
            words |= _FURTHER_OFF
        plan = move_plan(Ramp({**held, **words}, clock_hz).sixpoint(), way, 0.0)
        if plan is None:
            raise OutOfRange("velocity", velocity_pps, None, None, "pps make no ramp with that acceleration")
        items = tuple(WriteItem(name, axis, word) for name, word in words.items())
        return PacedLeg(items, speed * speed_unit, slope * slope_unit, plan)

    async def pace_back(self, axis: int, /) -> None:
        if axis not in self._before:
            return
        rows = self.memory.rows(axis)
        asked = (rows.rampmode, rows.xtarget, rows.xactual, rows.vactual)
        async with self.link.turn() as turn:
            mode, target, position, velocity = await self.link.io(turn).values(asked)
        if velocity:
            raise WrongState(f"axis {axis} of {self.session.name} moves", "stop it, and write its ramp again")
        words = self._before.pop(axis)
        names = [*_OFF, "AMAX", "DMAX", *(_FURTHER_OFF if "V2" in words else ())]
        if mode == r.POSITION and target == position:
            names.append("VMAX")
        else:  # after a stop: in velocity mode VMAX alone would turn it
            self.memory.want(rows.vmax, words["VMAX"])
        done = await self.registers.write_many([WriteItem(name, axis, words[name]) for name in names])
        if done.failed is not None:
            raise done.failed
