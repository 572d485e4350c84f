"""An axis right before it is sent somewhere: what decides is read, and nothing of the past holds the motor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ..core.register_io import RegisterIO, Snapshot
from . import roles as r
from .decoded_registers import DecodedRegisters
from .events import Events
from .memory import ChipMemory
from .ramp import Ramp
from .reader import ChipReader
from .standstill import Standstill


@dataclass(slots=True)
class Before:
    """The axis right before it is sent somewhere. Positions in microsteps, velocity in chip units."""

    axis: int
    ramp: Ramp
    mode: int
    position: int
    velocity: int
    target: int
    switches: dict[str, int]
    """SW_MODE and, where it could be read, RAMP_STAT by fields."""
    warnings: list[str] = field(default_factory=list)

    @property
    def stands(self) -> bool:
        return self.velocity == 0

    @property
    def positioning(self) -> bool:
        return self.mode == r.POSITION

    @property
    def velocity_pps(self) -> float:
        return self.velocity * self.ramp.velocity_unit_pps

    def blocked(self, way: int) -> str:
        """What stops motion that way (+1, -1); "" where nothing does."""
        side, name = ("l", "left switch") if way < 0 else ("r", "right switch")
        return name if self.switches[f"stop_{side}_enable"] and self.switches.get(f"status_stop_{side}") else ""


@dataclass(frozen=True, slots=True)
class Preparation:
    """Reads axes that are about to move. Nothing moves by it."""

    memory: ChipMemory
    decoded: DecodedRegisters
    log: Events
    reader: ChipReader
    standstill: Standstill

    async def prepare(self, io: RegisterIO, axes: Sequence[int]) -> list[Before]:
        """Read what decides, and see to it that nothing of the past holds the motor."""
        asked = [self.memory.chip.gconf]
        for axis in axes:
            rows = self.memory.rows(axis)
            asked += [rows.rampmode, rows.xactual, rows.vactual, rows.xtarget, rows.chopconf]
        held = await self.reader.peek(io, axes, asked)
        if any([await self._release(io, axis, held) for axis in axes]):
            held = await self.reader.peek(io, axes, asked)
        return [self._before(axis, held) for axis in axes]

    def _before(self, axis: int, held: Snapshot) -> Before:
        rows = self.memory.rows(axis)
        switches = held.fields(rows.sw_mode)
        if rows.ramp_stat.address in held.words:
            switches |= held.fields(rows.ramp_stat)
        return Before(
            axis,
            self.decoded.ramp(axis),
            held.value(rows.rampmode),
            held.value(rows.xactual),
            held.value(rows.vactual),
            held.value(rows.xtarget),
            switches,
            self._warnings(axis),
        )

    def _warnings(self, axis: int) -> list[str]:
        """Why a motor would not turn, or not as it should, though the ramp runs."""
        rows = self.memory.rows(axis)
        told = []
        chopconf, current = self.memory.word(rows.chopconf), self.memory.word(rows.ihold_irun)
        if chopconf is not None and not r.part(rows.chopconf, "toff").unpack(chopconf):
            told.append("CHOPCONF.toff is 0: the driver is off, and the motor has no current")
        if current is not None and not r.part(rows.ihold_irun, "IRUN").unpack(current):
            told.append("IRUN is 0: the motor runs at 1/32 of its full current")
        sw_mode = self.memory.word(rows.sw_mode) or 0
        if r.part(rows.sw_mode, "sg_stop").unpack(sw_mode) and r.part(rows.sw_mode, "en_softstop").unpack(sw_mode):
            told.append("SW_MODE has sg_stop and en_softstop, which do not go together")
        if self.log.lost:
            told.append("the chip was reset (GSTAT): what was set before that is lost")
        return told

    async def _release(self, io: RegisterIO, axis: int, held: Snapshot) -> bool:
        """End a stop by StallGuard, which would hold the axis; it goes nowhere until it is told to.

        Where RAMP_STAT may not be read, an axis that stands may be held by one.
        """
        rows = self.memory.rows(axis)
        unread = rows.ramp_stat.address not in held.words
        if held.word(rows.vactual) or not (unread or self.log.stalled(axis)):
            return False
        await self.standstill.keep(io, axis)
        if not self.memory.chip.clears_on_read:
            await self.reader.clear(io, [axis], stall=True)
        return True
