"""What a TMC5xxx has to be told so that a stall stops its motor (sg_stop; DS-TMC5160 14, DS-TMC5130 14)."""

from __future__ import annotations

from collections.abc import Sequence

from ..core.capabilities import Registers, StallStop
from ..core.results import WriteItem
from ..core.session import Session
from .decoded_registers import DecodedRegisters
from .memory import ChipMemory
from .position import PositionCalls

FULL_SCALE = 32
TSTEP_MAX = 0xFFFFF
VHIGH_NEVER = (1 << 23) - 1
"""Above what a ramp goes: nothing is another mode at high speed, in which no stall would stop the motor."""
_TABLE_MICROSTEPS = 256


class ChipStall(StallStop):
    """Of each axis, by its registers. StealthChop is off meanwhile: StallGuard2 measures with SpreadCycle only."""

    def __init__(
        self,
        session: Session,
        memory: ChipMemory,
        decoded: DecodedRegisters,
        registers: Registers,
        calls: PositionCalls,
    ) -> None:
        self._session = session
        self._memory = memory
        self._decoded = decoded
        self._registers = registers
        self._calls = calls

    async def full_step(self, axis: int) -> int:
        return self._decoded.mechanics(axis).microsteps_per_full_step

    def cruise_pps(self, axis: int) -> float | None:
        return self._calls.cruise_pps(axis)

    async def stall_threshold(self, axis: int) -> int:
        for kept in self._registers.kept(axis):
            if kept.name == "COOLCONF" and kept.axis == axis:
                return kept.fields["sgt"]
        return (await self._registers.read("COOLCONF", axis)).fields["sgt"]

    async def stall_writes(
        self, axis: int, velocity_pps: float, threshold: int, current_percent: float | None, *, stops: bool
    ) -> Sequence[WriteItem]:
        table = self._session.family.table
        microsteps = await self.full_step(axis)
        writes = [
            WriteItem("SW_MODE", axis, fields={"sg_stop": int(stops), "en_softstop": 0}),
            WriteItem("COOLCONF", axis, fields={"sgt": threshold, "sfilt": 0, "semin": 0}),
        ]
        if table.find("VCOOLTHRS", axis):
            ramp = self._decoded.ramp(axis)
            writes.append(WriteItem("VCOOLTHRS", axis, round(velocity_pps / ramp.velocity_unit_pps)))
            writes.append(WriteItem("VHIGH", axis, VHIGH_NEVER))
        else:
            clocks = self._session.clock_hz * microsteps / (_TABLE_MICROSTEPS * velocity_pps)
            writes.append(WriteItem("TCOOLTHRS", axis, min(round(clocks), TSTEP_MAX)))
            writes.append(WriteItem("THIGH", axis, 0))
        if self._has_stealthchop:
            writes.append(WriteItem("GCONF", None, fields={"en_pwm_mode": 0}))
        if current_percent is not None:
            irun = max(0, round(FULL_SCALE * current_percent / 100) - 1)
            writes.append(WriteItem("IHOLD_IRUN", axis, fields={"irun": irun}))
        return writes

    async def set_aside(self, axis: int) -> str:
        del axis
        if not self._has_stealthchop:
            return ""
        on = (await self._registers.read("GCONF", None)).fields["en_pwm_mode"]
        return "StealthChop (GCONF.en_pwm_mode)" if on else ""

    @property
    def _has_stealthchop(self) -> bool:
        return self._memory.chip.gconf.field_named("en_pwm_mode") is not None

    async def load(self, axis: int) -> int:
        return (await self._registers.read("DRV_STATUS", axis)).fields["SG_RESULT"]

    async def call_here(self, axis: int, position: int) -> None:
        await self._calls.set_position(axis, position)
