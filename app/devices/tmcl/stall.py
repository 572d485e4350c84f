"""What a module has to be told so that a stall stops its motor (FM-PD42-1241 7.2)."""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import WrongState
from ...registers.model import Register, Space
from ..core.capabilities import Registers, StallStop
from ..core.results import WriteItem
from ..core.session import Session
from .state import ModuleState

THRESHOLD, FILTER, STOP_ABOVE, CURRENT, COOLSTEP, POSITION = "ap174", "ap173", "ap181", "ap6", "ap172", "ap1"
PRESENT_LOAD = "ap206"
STEALTHCHOP = 187
"""PWM gradient: 0 switches StealthChop off, with which the driver measures no load."""


class ModuleStall(StallStop):
    """Of the one axis, by its parameters. StealthChop is off meanwhile, in modules that have it."""

    def __init__(self, session: Session, state: ModuleState, registers: Registers) -> None:
        self._session = session
        self._state = state
        self._registers = registers

    async def full_step(self, axis: int) -> int:
        await self._registers.read(self._state.roles.microsteps.name, axis)
        return self._state.microsteps

    def cruise_pps(self, axis: int) -> float | None:
        self._session.axis(axis)
        speed = self._state.last(self._state.roles.max_speed)
        return None if speed is None else speed * self._state.speed_unit_pps

    async def stall_threshold(self, axis: int) -> int:
        return (await self._registers.read(THRESHOLD, axis)).value

    async def stall_writes(
        self, axis: int, velocity_pps: float, threshold: int, current_percent: float | None, *, stops: bool
    ) -> Sequence[WriteItem]:
        if self._state.roles.load in self._state.roles.absent:
            raise WrongState("this module measures no load", "search its reference by a switch")
        above = round(velocity_pps / self._state.speed_unit_pps) if stops else 0
        writes = [
            WriteItem(STOP_ABOVE, axis, above),
            WriteItem(THRESHOLD, axis, threshold),
            WriteItem(FILTER, axis, 0),
            WriteItem(COOLSTEP, axis, 0),
        ]
        stealth = self._stealthchop
        if stealth is not None:
            writes.append(WriteItem(stealth.name, axis, 0))
        if current_percent is not None:
            writes.append(WriteItem(CURRENT, axis, max(1, round(255 * current_percent / 100))))
        return writes

    async def set_aside(self, axis: int) -> str:
        row = self._stealthchop
        if row is None or not (await self._registers.read(row.name, axis)).value:
            return ""
        return f"StealthChop ({row.name})"

    @property
    def _stealthchop(self) -> Register | None:
        row = self._state.table.at(STEALTHCHOP, Space.AXIS)
        return None if row is None or self._state.lacking.has(row) else row

    async def load(self, axis: int) -> int:
        return (await self._registers.read(PRESENT_LOAD, axis)).value

    async def call_here(self, axis: int, position: int) -> None:
        await self._registers.write(POSITION, axis, position)
