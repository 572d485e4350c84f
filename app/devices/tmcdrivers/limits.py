"""What the registers of a driver mean for soft limits: VACTUAL and the current scales. It counts no position."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ...calc.tmc5xxx.coil import (
    SCALER_FULL,
    SCALER_LEAST,
    SCALES,
    full_scale_rms_a,
    range_share,
    select_share,
)
from ..core.axis_limits import AxisLimits
from ..core.limit_rules.chip_rules import ChipRules
from ..core.limit_rules.quantities import Motion, PositionRegister, Quantity, View
from ..core.limit_rules.rules import AxisReading
from ..core.register_file import RegisterFile
from .memory import DriverMemory
from .reader import Reader
from .roles import FINEST, part


class DriverRules(ChipRules):
    """Of a driver whose words `memory` keeps."""

    def __init__(
        self,
        registers: RegisterFile,
        memory: DriverMemory,
        reader: Reader,
        limits: Sequence[AxisLimits],
        clock_hz: float,
    ) -> None:
        self._memory = memory
        self._reader = reader
        super().__init__(registers, memory.remembered_word, limits, clock_hz)

    def quantities_of(self, axis: int) -> Iterable[Quantity]:
        row, unit = self._memory.rows.vactual, self.clock_hz / (1 << 24)
        if row is not None:
            yield Quantity("velocity", row.name, row.address, row.decode, lambda _: unit, row.maximum)
        full = full_scale_a(self._memory.rows.model.name, self.limits[axis])
        if full is not None:
            yield self._currents(full)

    def _currents(self, full: float) -> Quantity:
        rows, row = self._memory.rows, self._memory.rows.ihold_irun
        run, hold = part(row, "IRUN"), part(row, "IHOLD")
        vsense, scaler, ranges, model = rows.chopconf.field_named("vsense"), rows.scaler, rows.current_range, rows.model

        def full_a(view: View) -> float:
            if scaler is None or ranges is None:
                word = view(rows.chopconf.address)
                return full * select_share(model.name, 0 if word is None or vsense is None else vsense.unpack(word))
            word = view(scaler.address)
            # 1..31 are not allowed; whatever a chip makes of them is not above the least that is
            scaled = full * select_share(model.name, max((word or SCALER_FULL), SCALER_LEAST))
            word = view(ranges[0].address)
            return scaled if word is None else scaled * range_share(model.name, ranges[1].unpack(word))

        def scale(word: int) -> float:
            return (max(run.unpack(word), hold.unpack(word)) + 1) / SCALES

        def advice(share: float) -> str:
            count = int(share * SCALES) - 1
            return (
                f"write IRUN and IHOLD {count} or less"
                if count >= 0
                else f"lower {scaler.name}"
                if scaler
                else "set vsense"
            )

        others = frozenset({rows.chopconf.address})
        if scaler is not None and ranges is not None:
            others = frozenset({scaler.address, ranges[0].address})
        return Quantity("current", row.name, row.address, scale, full_a, 1.0, others, advice=advice)

    def positions_of(self, axis: int) -> Iterable[PositionRegister]:
        return ()

    def sources_of(self, axis: int) -> Iterable[int]:
        row = self._memory.rows.vactual
        return () if row is None else (row.address,)

    def motion(self, axis: int, view: View, address: int | None = None) -> Motion | None:
        row = self._memory.rows.vactual
        word = None if row is None else view(row.address)
        if row is None or word == 0:
            return None
        way = 0 if word is None else 1 if row.decode(word) > 0 else -1
        return Motion(tuple(self.quantities[axis]), positioning=False, way=way, jumps=True)

    async def learn(self) -> None:
        if any(limits.given for limits in self.limits):
            await self._reader.read_axis()

    async def read_axis(self, axis: int) -> AxisReading:
        reading = await self._reader.read_axis()
        place = reading.held.value(self._memory.rows.mscnt) * self._memory.microsteps // FINEST
        return AxisReading(place, self._reader.speed_pps(reading.held))

    def braking(self, axis: int, reading: AxisReading, view: View) -> float | None:
        return 0.0  # VACTUAL 0 stops the field at once


def full_scale_a(model: str, limits: AxisLimits) -> float | None:
    """RMS at scale 31 with the most that vsense, scaler and range let through [A]; None where no figure tells it."""
    return full_scale_rms_a(model, limits.sense_resistor_ohm, limits.current_full_scale_a)
