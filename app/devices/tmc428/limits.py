"""TMC428 and TMC4210: what their registers mean (DS-TMC428 8; DS-TMC4210). The dividers are part of every speed.

Currents of a TMC428 are scales of what its power stages give (DS-TMC428 8.8), so `current_full_scale_a` makes amperes
of them; a TMC4210 has none. What cannot be told: what bits of the driver chain's RAM and cover datagrams do in a power
stage.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache

from ...calc.units.tmc428 import MAX_DIVIDER, acceleration_hz_s, pulse_rate_hz
from ...registers.model import Register
from ..core.axis_limits import AxisLimits
from ..core.limit_rules.chip_rules import ChipRules
from ..core.limit_rules.quantities import Motion, PositionRegister, Quantity, View, position_of, sign
from ..core.limit_rules.rules import AxisReading
from ..core.register_file import RegisterFile
from .axis_roles import HOLD_MODE, POSITIONING_MODES, AxisRoles
from .memory import RampMemory

MOST = 2047
"""The greatest velocity and acceleration."""
CURRENTS = "is_agtat_is_aleat_is_v0_a_threshold"
EIGHTHS = 8


@lru_cache(maxsize=256)
def velocity_unit(pulse_div: int, clock_hz: float) -> float:
    """[pps]"""
    return pulse_rate_hz(1, pulse_div, clock_hz)


@lru_cache(maxsize=1024)
def acceleration_unit(pulse_div: int, ramp_div: int, clock_hz: float) -> float:
    """[pps^2]"""
    return acceleration_hz_s(1, pulse_div, ramp_div, clock_hz)


class RampRules(ChipRules):
    """Of the registers of a ramp generator chip."""

    def __init__(
        self, registers: RegisterFile, memory: RampMemory, limits: Sequence[AxisLimits], clock_hz: float
    ) -> None:
        self._memory = memory
        super().__init__(registers, memory.known, limits, clock_hz)

    # --- the table ------------------------------------------------------------------------------

    def quantities_of(self, axis: int) -> Iterable[Quantity]:
        rows = self._memory.rows[axis]
        dividers = frozenset({rows.dividers.address})

        def of_dividers(view: View) -> tuple[int, int]:
            word = view(rows.dividers.address)
            pulse, ramp = (0, 0) if word is None else (rows.pulse_div.unpack(word), rows.ramp_div.unpack(word))
            # Where nobody knows, nothing is faster than without any; a divider that no chip has was read wrongly.
            return pulse if pulse <= MAX_DIVIDER else 0, ramp if ramp <= MAX_DIVIDER else 0

        def velocity(view: View) -> float:
            return velocity_unit(of_dividers(view)[0], self.clock_hz)

        def acceleration(view: View) -> float:
            return acceleration_unit(*of_dividers(view), self.clock_hz)

        for row in (rows.v_max, rows.v_min):
            yield Quantity("velocity", row.name, row.address, row.decode, velocity, MOST, dividers)
        for row in (rows.v_target, rows.v_actual):
            # What the chip itself sets there is not above v_max, so what nobody knows adds nothing.
            yield Quantity("velocity", row.name, row.address, row.decode, velocity, 0, dividers, at_start=False)
        row = rows.a_max
        yield Quantity("acceleration", row.name, row.address, row.decode, acceleration, MOST, dividers)
        full_scale_a = self.limits[axis].current_full_scale_a
        found = self._link.table.find(CURRENTS, axis)
        if found is not None and full_scale_a is not None:
            yield _currents(found[0], full_scale_a)

    def positions_of(self, axis: int) -> Iterable[PositionRegister]:
        rows = self._memory.rows[axis]
        for row in (rows.x_target, rows.x_actual):
            yield PositionRegister(row.name, row.address, position_of(row))

    def sources_of(self, axis: int) -> Iterable[int]:
        rows = self._memory.rows[axis]
        moving = (rows.x_target, rows.x_actual, rows.v_max, rows.v_target, rows.v_actual, rows.a_max, rows.reference)
        return (row.address for row in moving)

    def motion(self, axis: int, view: View, address: int | None = None) -> Motion | None:
        rows = self._memory.rows[axis]
        reference, v_max, a_max = (view(row.address) for row in (rows.reference, rows.v_max, rows.a_max))
        used = [one for one in self.quantities[axis] if one.at_start]
        mode = None if reference is None else rows.mode.unpack(reference)
        if mode == HOLD_MODE:
            word = view(rows.v_actual.address)
            velocity = 0 if word is None else rows.v_actual.decode(word)
            held = [one for one in self.quantities[axis] if one.kind == "current" or one.name == rows.v_actual.name]
            return Motion(tuple(held), positioning=False, way=sign(velocity), jumps=True) if velocity else None
        if a_max == 0:
            return None
        if mode in POSITIONING_MODES:
            if v_max == 0:
                return None
            target, counter = view(rows.x_target.address), view(rows.x_actual.address)
            return Motion(
                tuple(used),
                positioning=True,
                target=None if target is None else rows.x_target.decode(target),
                counter=counter,
            )
        word = view(rows.v_target.address)
        wanted = None if word is None else rows.v_target.decode(word)
        if wanted == 0:
            return None
        by = {rows.v_max.name, rows.v_min.name}  # it turns by v_target instead
        used = [one for one in used if one.name not in by]
        if wanted is not None:
            used += [one for one in self.quantities[axis] if one.name == rows.v_target.name]
        return Motion(tuple(used), positioning=False, way=0 if wanted is None else sign(wanted))

    # --- frames ---------------------------------------------------------------------------------

    def forgotten(self, frame: bytes) -> Iterable[int]:
        """While it positions, the chip itself sets v_target."""
        for address, _ in self.writes(frame):
            for rows in self._memory.rows:
                if address in (rows.x_target.address, rows.reference.address):
                    yield rows.v_target.address

    # --- what is known --------------------------------------------------------------------------

    async def learn(self) -> None:
        for axis, limits in enumerate(self.limits):
            if limits.given:
                found = self._link.table.find(CURRENTS, axis)
                currents = () if found is None or limits.current_max_a is None else (found[0],)
                await self._registers.learn((*_decisive(self._memory.rows[axis]), *currents))
                await self.read_axis(axis)

    # --- the watch ------------------------------------------------------------------------------

    async def read_axis(self, axis: int) -> AxisReading:
        link, rows = self._link, self._memory.rows[axis]
        async with link.turn() as turn:
            io = link.io(turn)
            reference = await io.read(rows.reference)
            dividers = await io.read(rows.dividers)
            target = await io.value(rows.x_target)
            velocity = await io.value(rows.v_actual)
            position = await io.value(rows.x_actual)
            asked_s = io.asked_s
        link.session.saw_position(axis, position, asked_s)
        unit_pps = velocity_unit(min(rows.pulse_div.unpack(dividers), MAX_DIVIDER), self.clock_hz)
        positioning = rows.mode.unpack(reference) in POSITIONING_MODES
        return AxisReading(position, velocity * unit_pps, target=target if positioning else None)

    def braking(self, axis: int, reading: AxisReading, view: View) -> float | None:
        one = next(one for one in self.quantities[axis] if one.kind == "acceleration")
        a_pps2 = one.value(view)
        if a_pps2 is None:
            return None
        # With a_max 0 a stop is one at once (`RampStops`).
        return reading.velocity_pps**2 / (2 * a_pps2) if a_pps2 else 0.0


def _decisive(rows: AxisRoles) -> tuple[Register, ...]:
    return (
        rows.reference, rows.dividers, rows.v_min, rows.v_max, rows.a_max, rows.x_target, rows.v_target
    )  # fmt: skip


def _currents(row: Register, full_scale_a: float) -> Quantity:
    parts = [part for part in row.fields if part.name.startswith("is_")]

    def eighths(word: int) -> float:
        return max(part.unpack(word) or EIGHTHS for part in parts) / EIGHTHS

    def advice(share: float) -> str:
        names = ", ".join(part.name for part in parts)
        count = min(int(share * EIGHTHS), EIGHTHS - 1)
        return f"write {names} 1..{count}" if count else "an eighth of full scale is more: use another power stage"

    return Quantity("current", row.name, row.address, eighths, lambda _: full_scale_a, 1.0, advice=advice)
