"""TMC5xxx: what their registers mean. Speeds and accelerations count in units of the clock (DS-TMC5160 12.1), currents
in
scales of what the sense resistor makes of them (`calc.tmc5xxx.coil`).

Most of these registers cannot be read: where one was set before this connection, a limit of its quantity lets no motion
begin until it is written. V1 and the thresholds of the driver are no speeds that an axis gets to by them, and not
limited. With StealthChop and its amplitude set by hand (PWMCONF) the scales do not tell the current.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ...calc.tmc5xxx.chips import CHIPS
from ...calc.tmc5xxx.coil import (
    SCALER_FULL,
    SCALER_LEAST,
    SCALES,
    full_scale_rms_a,
    range_share,
    select_share,
)
from ...calc.units.tmc5xxx import ACCELERATION_MAX, VELOCITY_MAX, acceleration_unit_pps2, velocity_unit_pps
from ..core.axis_limits import AxisLimits
from ..core.limit_rules.chip_rules import ChipRules
from ..core.limit_rules.quantities import Motion, PositionRegister, Quantity, View, position_of
from ..core.limit_rules.rules import AxisReading
from ..core.register_file import RegisterFile
from . import roles as r
from .memory import ChipMemory

SPEEDS = ("VMAX", "VSTART", "VSTOP")
ACCELERATIONS = ("AMAX", "DMAX", "A1", "D1", "A2", "D2")
BELOW_V1 = ("A1", "D1")
"""Without a V1 nothing goes by these."""
BELOW_V2 = ("A2", "D2")
"""Nor by these without a V2."""
SCALER = "GLOBAL_SCALER"


class SixPointRules(ChipRules):
    """Of a chip whose words `memory` keeps."""

    def __init__(
        self, registers: RegisterFile, memory: ChipMemory, limits: Sequence[AxisLimits], clock_hz: float
    ) -> None:
        self._memory = memory
        super().__init__(registers, memory.remembered_word, limits, clock_hz)

    # --- the table ------------------------------------------------------------------------------

    def quantities_of(self, axis: int) -> Iterable[Quantity]:
        ramp = self._memory.rows(axis).ramp
        velocity, acceleration = velocity_unit_pps(self.clock_hz), acceleration_unit_pps2(self.clock_hz)
        for name in SPEEDS:
            row = ramp[name]
            yield Quantity("velocity", name, row.address, row.decode, lambda _: velocity, VELOCITY_MAX)
        for name in (name for name in ACCELERATIONS if name in ramp):
            row = ramp[name]
            yield Quantity("acceleration", name, row.address, row.decode, lambda _: acceleration, row.maximum)
        full = full_scale_a(self._registers.link.session.model, self.limits[axis])
        if full is not None:
            yield self._currents(axis, full)

    def _currents(self, axis: int, full: float) -> Quantity:
        rows = self._memory.rows(axis)
        run, hold = r.part(rows.ihold_irun, "IRUN"), r.part(rows.ihold_irun, "IHOLD")
        vsense, scaler = rows.chopconf.field_named("vsense"), rows.find(SCALER)

        model = self._registers.link.session.model
        ranges = rows.current_range if CHIPS[model].sensing.range_va else None

        def full_a(view: View) -> float:
            if scaler is not None:
                word = view(scaler.address)
                share = SCALER_FULL if word is None else scaler.decode(word) or SCALER_FULL
                # 1..31 are not allowed; whatever a chip makes of them is not above the least that is.
                scaled = full * select_share(model, max(share, SCALER_LEAST))
                word = None if ranges is None else view(ranges[0].address)
                return scaled if ranges is None or word is None else scaled * range_share(model, ranges[1].unpack(word))
            word = view(rows.chopconf.address)
            return full * select_share(model, 0 if word is None or vsense is None else vsense.unpack(word))

        def scale(word: int) -> float:
            return (max(run.unpack(word), hold.unpack(word)) + 1) / SCALES

        def advice(share: float) -> str:
            count = int(share * SCALES) - 1
            return f"write IRUN and IHOLD {count} or less" if count >= 0 else f"lower {SCALER if scaler else 'vsense'}"

        others = frozenset({scaler.address if scaler is not None else rows.chopconf.address})
        others |= frozenset(() if ranges is None else (ranges[0].address,))
        return Quantity("current", "IHOLD_IRUN", rows.ihold_irun.address, scale, full_a, 1.0, others, advice=advice)

    def positions_of(self, axis: int) -> Iterable[PositionRegister]:
        rows = self._memory.rows(axis)
        for row in (rows.xtarget, rows.xactual):
            yield PositionRegister(row.name, row.address, position_of(row))

    def sources_of(self, axis: int) -> Iterable[int]:
        rows = self._memory.rows(axis)
        return (row.address for row in (rows.rampmode, rows.xtarget, rows.xactual, rows.vmax, rows.amax))

    def motion(self, axis: int, view: View, address: int | None = None) -> Motion | None:
        rows = self._memory.rows(axis)
        mode, vmax = view(rows.rampmode.address), view(rows.vmax.address)
        if vmax == 0 or view(rows.amax.address) == 0:
            return None
        kind = None if mode is None else mode & 3
        if kind == r.HOLD:
            return None
        by_v1 = view(rows.ramp["V1"].address) != 0
        v2 = rows.ramp.get("V2")
        by_v2 = v2 is not None and view(v2.address) != 0
        positioning = kind in (r.POSITION, None)
        used = [
            one
            for one in self.quantities[axis]
            if (by_v1 or one.name not in BELOW_V1)
            and (by_v2 or one.name not in BELOW_V2)
            and (positioning or one.name not in (*BELOW_V1, *BELOW_V2, "DMAX", "VSTOP"))
        ]
        if kind in (r.FORWARD, r.BACKWARD):
            return Motion(tuple(used), positioning=False, way=1 if kind == r.FORWARD else -1)
        target = view(rows.xtarget.address)
        position = None if target is None or kind is None else rows.xtarget.decode(target)
        return Motion(tuple(used), kind is not None, position, counter=view(rows.xactual.address))

    # --- what is known --------------------------------------------------------------------------

    async def learn(self) -> None:
        for axis, limits in enumerate(self.limits):
            if limits.given:
                rows = self._memory.rows(axis)
                await self._registers.learn((rows.rampmode, rows.chopconf, rows.xtarget, *rows.settings))
                await self.read_axis(axis)

    # --- the watch ------------------------------------------------------------------------------

    async def read_axis(self, axis: int) -> AxisReading:
        link, rows = self._registers.link, self._memory.rows(axis)
        async with link.turn() as turn:
            io = link.io(turn)
            mode, target, velocity, position = await io.values(
                (rows.rampmode, rows.xtarget, rows.vactual, rows.xactual)
            )
            asked_s = io.asked_s
        link.session.saw_position(axis, position, asked_s)
        unit = velocity_unit_pps(self.clock_hz)
        return AxisReading(position, velocity * unit, target=target if mode == r.POSITION else None)

    def braking(self, axis: int, reading: AxisReading, view: View) -> float | None:
        # A stop brakes with AMAX as the user has set it, whatever an earlier stop has written there.
        word = self._memory.wanted(self._memory.rows(axis).amax)
        if word is None:
            return None
        # AMAX 0 would never brake: such a stop takes the greatest there is.
        return reading.velocity_pps**2 / (2 * (word or ACCELERATION_MAX) * acceleration_unit_pps2(self.clock_hz))


def full_scale_a(model: str, limits: AxisLimits) -> float | None:
    """RMS at scale 31 with the most that vsense, scaler and range let through [A]; None where no figure tells it."""
    return full_scale_rms_a(model, limits.sense_resistor_ohm, limits.current_full_scale_a)
