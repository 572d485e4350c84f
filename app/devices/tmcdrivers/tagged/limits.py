"""What the registers mean for soft limits: the current scale and VSENSE."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ....calc.tmc5xxx.coil import select_share
from ...core.axis_limits import AxisLimits
from ...core.limit_rules.chip_rules import ChipRules
from ...core.limit_rules.quantities import Motion, PositionRegister, Quantity, View
from ...core.limit_rules.rules import AxisReading
from ...core.register_file import RegisterFile
from ..limits import full_scale_a
from .memory import TaggedMemory

SCALES = 32


class TaggedRules(ChipRules):
    """Of a driver that counts no position and has no velocity."""

    def __init__(
        self, registers: RegisterFile, memory: TaggedMemory, limits: Sequence[AxisLimits], clock_hz: float
    ) -> None:
        self._memory = memory
        super().__init__(registers, memory.word_at, limits, clock_hz)

    def quantities_of(self, axis: int) -> Iterable[Quantity]:
        rows = self._memory.rows
        full = full_scale_a(rows.model.name, self.limits[axis])
        if full is None:
            return
        row, scale, sense = rows.currents, rows.currents.field_named("CS"), rows.configuration.field_named("vsense")
        assert scale is not None  # both are rows of ours
        assert sense is not None

        def full_a(view: View) -> float:
            word = view(rows.configuration.address)
            return full * select_share(rows.model.name, 0 if word is None else sense.unpack(word))

        def advice(share: float) -> str:
            count = int(share * SCALES) - 1
            return f"write CS {count} or less" if count >= 0 else "set vsense"

        yield Quantity(
            "current",
            row.name,
            row.address,
            lambda word: (scale.unpack(word) + 1) / SCALES,
            full_a,
            1.0,
            frozenset({rows.configuration.address}),
            advice=advice,
        )

    def positions_of(self, axis: int) -> Iterable[PositionRegister]:
        return ()

    def sources_of(self, axis: int) -> Iterable[int]:
        return ()

    def motion(self, axis: int, view: View, address: int | None = None) -> Motion | None:
        return None

    async def learn(self) -> None:
        """Nothing can be read: what was not written is not known."""

    async def read_axis(self, axis: int) -> AxisReading:
        return AxisReading(0, 0.0)

    def braking(self, axis: int, reading: AxisReading, view: View) -> float | None:
        return 0.0
