"""What the registers of a ramp generator mean for soft limits.

A limit of speed or acceleration is one of the chip's own numbers, for nobody here knows what they count in; registers
without a standard meaning are not judged.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ....registers.listed.ramp import BACKWARD, FORWARD, HOLD, POSITION
from ....registers.model import Register
from ...core.axis_limits import AxisLimits
from ...core.limit_rules.chip_rules import ChipRules
from ...core.limit_rules.quantities import Motion, PositionRegister, Quantity, QuantityKind, View, position_of
from ...core.limit_rules.rules import AxisReading
from ...core.register_file import RegisterFile
from .ongoing import ChipMotions
from .state import ChipState


class ListedChipRules(ChipRules):
    """Of a chip whose words `state` keeps."""

    def __init__(
        self,
        registers: RegisterFile,
        state: ChipState,
        motions: ChipMotions,
        limits: Sequence[AxisLimits],
        clock_hz: float,
    ) -> None:
        self._state = state
        self._motions = motions
        super().__init__(registers, state.known, limits, clock_hz)

    # --- the table ------------------------------------------------------------------------------

    def quantities_of(self, axis: int) -> Iterable[Quantity]:
        ramp = self._state.ramps[axis]
        yield _quantity("velocity", ramp.max_speed)
        yield _quantity("acceleration", ramp.acceleration)
        if ramp.deceleration is not None:
            yield _quantity("acceleration", ramp.deceleration)

    def positions_of(self, axis: int) -> Iterable[PositionRegister]:
        ramp = self._state.ramps[axis]
        for row in (ramp.target, ramp.position):
            yield PositionRegister(row.name, row.address, position_of(row))

    def sources_of(self, axis: int) -> Iterable[int]:
        return (row.address for row in self._state.ramps[axis].moving)

    def motion(self, axis: int, view: View, address: int | None = None) -> Motion | None:
        ramp = self._state.ramps[axis]
        if view(ramp.max_speed.address) == 0 or view(ramp.acceleration.address) == 0:
            return None
        word = view(ramp.mode.register.address)
        mode = None if word is None else ramp.mode.unpack(word)
        if mode == HOLD:
            return None
        braking = None if ramp.deceleration is None else ramp.deceleration.name
        turning = tuple(one for one in self.quantities[axis] if one.name != braking)
        if mode in (FORWARD, BACKWARD):
            return Motion(turning, positioning=False, way=1 if mode == FORWARD else -1)
        target = view(ramp.target.address)
        place = None if target is None or mode is None else ramp.target.decode(target)
        counter = view(ramp.position.address)
        return Motion(self.quantities[axis], mode == POSITION, place, counter=counter)

    # --- what is known --------------------------------------------------------------------------

    async def learn(self) -> None:
        for axis, limits in enumerate(self.limits):
            if limits.given:
                ramp = self._state.ramps[axis]
                rows = (ramp.mode.register, ramp.target, *_settings(ramp.max_speed, ramp.acceleration))
                await self._registers.learn(rows)
                await self.read_axis(axis)

    # --- the watch ------------------------------------------------------------------------------

    async def read_axis(self, axis: int) -> AxisReading:
        link = self._registers.link
        async with link.turn() as turn:
            reading = await self._motions.poll(link.io(turn), self._state.ramps[axis])
        return AxisReading(
            reading.position, float(reading.speed), target=reading.target if reading.mode == POSITION else None
        )

    def braking(self, axis: int, reading: AxisReading, view: View) -> float | None:
        word = self._state.wanted(self._state.ramps[axis].acceleration)
        return reading.velocity_pps**2 / (2 * word) if word else None


def _settings(*rows: Register) -> tuple[Register, ...]:
    return tuple(row for row in rows if row.access.readable)


def _quantity(kind: QuantityKind, row: Register) -> Quantity:
    return Quantity(kind, row.name, row.address, row.decode, lambda _: 1.0, float(row.maximum))
