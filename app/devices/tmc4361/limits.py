"""TMC4361: what its registers mean (DS-TMC4361 8). It counts in pps of the clock that CLK_FREQ tells it of: with
another clock everything is that much faster.

Shadow registers and the pipeline of targets count as what START_CONF makes of them. Currents are scales of what the
power stage gives (SCALE_VALUES, as far as CURRENT_CONF takes them), so `current_full_scale_a` makes amperes of them.
What cannot be told: steps from outside (sdin_mode, GEAR_RATIO), what closed loop adds while it catches up, what cover
datagrams do in a driver, DFREEZE, and when a start signal comes that registers wait for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeAlias

from ...calc.units.tmc4361 import CLOCK_HZ_MAX, CLOCK_HZ_MIN, FORMATS, Units
from ...registers.model import Field, Register, to_signed
from ..core.axis_limits import AxisLimits
from ..core.limit_rules.chip_rules import ChipRules
from ..core.limit_rules.quantities import Motion, PositionRegister, Quantity, QuantityKind, View, position_of, sign
from ..core.limit_rules.rules import AxisReading
from ..core.register_file import RegisterFile
from . import prediction, roles
from .cruise import Cruise
from .memory import ChipMemory

SPEEDS = ("VMAX", "VSTART", "VSTOP")
ACCELERATIONS = ("AMAX", "DMAX", "ASTART", "DFINAL", "DSTOP")
SHADOWS: dict[int, tuple[str | None, str | None, str | None, str | None]] = {
    0: ("VMAX", "VMAX", "VMAX", "VMAX"),
    1: ("AMAX", "AMAX", "AMAX", "AMAX"),
    2: ("DMAX", "DMAX", "DMAX", "DMAX"),
    3: ("ASTART", None, "ASTART", "ASTART"),
    4: ("DFINAL", None, "DFINAL", "DFINAL"),
    6: ("VSTART", None, "VSTART", "VSTOP"),
    7: ("VSTOP", "VMAX", "VMAX", "VMAX"),
    8: (None, "AMAX", "AMAX", "AMAX"),
    9: (None, "DMAX", "DMAX", "DMAX"),
    10: (None, None, "ASTART", "ASTART"),
    11: (None, None, "DFINAL", "DFINAL"),
    13: (None, None, "VSTART", "VSTOP"),
}
"""Which register SH_REGn is the shadow of, by START_CONF.shadow_option; those of bows and modes apart (DS-TMC4361
10.4)."""
ASTART_BITS = (1 << 24) - 1
"""The highest bit of ASTART is a sign for something else."""
SCALES = 256
PIPES = tuple(roles.row(f"X_PIPE{stage}") for stage in range(8))
SHADOW_ROWS = {number: roles.row(f"SH_REG{number}") for number in SHADOWS}
SHADOW_OPTION = roles.part(roles.START_CONF, "shadow_option")
PIPE_USES = tuple(roles.part(roles.START_CONF, f"pipeline_en[{use}]") for use in range(4))
DIRECT = roles.part(roles.GENERAL_CONF, "direct_acc_val_en")
CLIP = roles.row("PID_DV_CLIP")
SCALE_VALUES = roles.row("SCALE_VALUES")
SCALE_VALUES_FIELDS = {part.name: part for part in SCALE_VALUES.fields}
Unit: TypeAlias = Callable[[View], float]
"""What a count of 1 is, by what registers hold."""


class SRampRules(ChipRules):
    """Of a chip whose words `memory` keeps, and its ramp as the user wants it `cruise`."""

    def __init__(
        self,
        registers: RegisterFile,
        memory: ChipMemory,
        cruise: Cruise,
        limits: Sequence[AxisLimits],
        clock_hz: float,
    ) -> None:
        self._memory = memory
        self._cruise = cruise
        self._accelerations = {  # by whether direct units are on, [pps^2] of a 1
            direct: Units(max(clock_hz, CLOCK_HZ_MIN), direct_acceleration=direct).least("AMAX")
            for direct in (False, True)
        }
        super().__init__(registers, memory.remembered_word, limits, clock_hz)

    # --- the table ------------------------------------------------------------------------------

    def quantities_of(self, axis: int) -> Iterable[Quantity]:
        clocked = frozenset({roles.CLK_FREQ.address})
        units = clocked | {roles.GENERAL_CONF.address}
        for name in SPEEDS:
            yield self._quantity(roles.row(name), name, self._velocity, clocked)
        yield Quantity("velocity", CLIP.name, CLIP.address, CLIP.decode, lambda _: 1.0, 1 << 31, at_start=False)
        for name in ACCELERATIONS:
            yield self._quantity(roles.row(name), name, self._acceleration, units, at_start=name != "DSTOP")
        for number, row in SHADOW_ROWS.items():
            yield from self._shadows(number, row)
        full_scale_a = self.limits[axis].current_full_scale_a
        if full_scale_a is not None:
            yield from _currents(full_scale_a)

    def _quantity(
        self,
        row: Register,
        name: str,
        unit: Unit,
        others: frozenset[int],
        *,
        at_start: bool = True,
    ) -> Quantity:
        kind: QuantityKind = "velocity" if name in SPEEDS else "acceleration"
        most = 1 << (FORMATS[name].whole + FORMATS[name].decimals)
        return Quantity(kind, row.name, row.address, _counts(name), unit, most, others, at_start)

    def _shadows(self, number: int, row: Register) -> Iterable[Quantity]:
        """A shadow register may stand for a speed under one option and for an acceleration under another."""
        for name in sorted({name for name in SHADOWS[number] if name is not None}):
            options = frozenset(option for option, found in enumerate(SHADOWS[number]) if found == name)
            unit = self._velocity if name in SPEEDS else self._acceleration

            def in_use(view: View, options: frozenset[int] = options, unit: Unit = unit) -> float:
                word = view(roles.START_CONF.address)
                # Where nobody knows, it may be any of them.
                return unit(view) if word is None or SHADOW_OPTION.unpack(word) in options else 0.0

            others = frozenset({roles.CLK_FREQ.address, roles.GENERAL_CONF.address, roles.START_CONF.address})
            yield self._quantity(row, name, in_use, others, at_start=False)

    def _told(self, view: View) -> float:
        """How many times as fast everything is as the registers say; infinite where CLK_FREQ is 0."""
        told_hz = view(roles.CLK_FREQ.address)
        if told_hz is None:
            told_hz = roles.CLK_FREQ.reset
        told_hz = roles.CLK_FREQ.decode(told_hz or 0)
        if told_hz > CLOCK_HZ_MAX:  # no chip has that: it was read wrongly, and the least may be right
            told_hz = round(CLOCK_HZ_MIN)
        return self.clock_hz / told_hz if told_hz else float("inf")

    def _velocity(self, view: View) -> float:
        return self._told(view) / 256

    def _acceleration(self, view: View) -> float:
        word = view(roles.GENERAL_CONF.address)
        if word is None:
            return max(self._accelerations[True], self._accelerations[False] * self._told(view) ** 2)
        if DIRECT.unpack(word):
            return self._accelerations[True]
        return self._accelerations[False] * self._told(view) ** 2

    def positions_of(self, axis: int) -> Iterable[PositionRegister]:
        for row in (roles.XTARGET, roles.XACTUAL):
            yield PositionRegister(row.name, row.address, position_of(row))
        for row in PIPES:
            yield PositionRegister(row.name, row.address, _piped)

    def sources_of(self, axis: int) -> Iterable[int]:
        moving = (roles.RAMPMODE, roles.XTARGET, roles.XACTUAL, roles.VMAX, roles.AMAX, roles.START_CONF)
        return (row.address for row in moving)

    def motion(self, axis: int, view: View, address: int | None = None) -> Motion | None:
        mode, word = view(roles.RAMPMODE.address), view(roles.VMAX.address)
        vmax = None if word is None else roles.VMAX.decode(word)
        if vmax == 0:
            return None
        used = tuple(one for one in self.quantities[axis] if one.at_start)
        jumps = mode is not None and mode & 3 == roles.HOLD
        if jumps:
            used = tuple(one for one in used if one.kind != "acceleration" and one.name != "VSTART")
        if mode is not None and mode & roles.POSITIONING_BIT:
            target, counter = view(roles.XTARGET.address), view(roles.XACTUAL.address)
            position = None if target is None else roles.XTARGET.decode(target)
            return Motion(used, positioning=True, target=position, jumps=jumps, counter=counter)
        return Motion(used, positioning=False, way=0 if vmax is None or mode is None else sign(vmax), jumps=jumps)

    # --- what is known --------------------------------------------------------------------------

    async def learn(self) -> None:
        if not self.limits[0].given:
            return
        decisive = (*roles.RAMP, roles.row("DSTOP"), roles.XTARGET, roles.CURRENT_CONF, SCALE_VALUES)
        await self._registers.learn((*decisive, *SHADOW_ROWS.values(), *PIPES))
        await self.read_axis(roles.AXIS)

    # --- the watch ------------------------------------------------------------------------------

    async def read_axis(self, axis: int) -> AxisReading:
        async with self._link.turn() as turn:
            io = self._link.io(turn)
            mode, target, acceleration, velocity, position = await io.values(
                (roles.RAMPMODE, roles.XTARGET, roles.AACTUAL, roles.VACTUAL, roles.XACTUAL)
            )
            asked_s = io.asked_s
        self._link.session.saw_position(axis, position, asked_s)
        faster = self._told(self._memory.remembered_word)
        going_to = target if mode & roles.POSITIONING_BIT else None
        return AxisReading(position, velocity * faster, acceleration * faster**2, going_to)

    def braking(self, axis: int, reading: AxisReading, view: View) -> float | None:
        ramp = self._memory.ramp()
        if ramp is None or ramp.never_slows():
            return 0.0 if ramp is not None else None  # such a stop is one at once
        faster = self._told(view)
        plan = prediction.to_velocity(
            ramp, self._cruise.shape, 0.0, reading.velocity_pps / faster, reading.acceleration_pps2 / faster**2
        )
        return None if plan is None else abs(float(plan.curve(2).position[-1]))


def _counts(name: str) -> Callable[[int], float]:
    """The number that a word holds, by the register that it belongs to or is a shadow of."""
    if name == "VMAX":
        return lambda word: to_signed(word & 0xFFFF_FFFF, 32)
    return (lambda word: word & ASTART_BITS) if name in ACCELERATIONS else lambda word: word & 0x7FFF_FFFF


def _piped(word: int, view: View) -> int | None:
    """A stage of the pipeline is a target, unless START_CONF makes something else of it and no target."""
    conf = view(roles.START_CONF.address)
    if conf is not None and not PIPE_USES[0].unpack(conf) and any(use.unpack(conf) for use in PIPE_USES):
        return None
    return to_signed(word & 0xFFFF_FFFF, 32)


def _currents(full_scale_a: float) -> Iterable[Quantity]:
    def enabled(name: str) -> Field:
        return roles.part(roles.CURRENT_CONF, name)

    drive, second, hold = (enabled(f"{name}_current_scale_en") for name in ("drive", "sec_drive", "hold"))
    closed = enabled("closed_loop_scale_en")
    boosts = [enabled(f"boost_current_{when}_en") for when in ("on_acc", "on_dec", "after_start")]

    def share(conf: int | None, word: int) -> float:
        """The greatest of the scales in use. What nothing scales has full current."""
        scales = {name: SCALE_VALUES_FIELDS[name].unpack(word) for name in SCALE_VALUES_FIELDS}
        if conf is None:
            return 1.0
        if closed.unpack(conf):
            return (scales["cl_imax"] + 1) / SCALES
        used = [scales["drv1_scale_val"] if drive.unpack(conf) else SCALES - 1]
        if second.unpack(conf):
            used.append(scales["drv2_scale_val"])
        if hold.unpack(conf):
            used.append(scales["hold_scale_val"])
        if any(boost.unpack(conf) for boost in boosts):
            used.append(scales["boost_scale_val"])
        return (max(used) + 1) / SCALES

    # Two registers make one scale; each is judged by what the other holds.
    def by_values(view: View) -> float:
        word = view(SCALE_VALUES.address)
        return full_scale_a * (share(view(roles.CURRENT_CONF.address), word) if word is not None else 1.0)

    yield Quantity(
        "current",
        roles.CURRENT_CONF.name,
        roles.CURRENT_CONF.address,
        lambda _: 1.0,
        by_values,
        1.0,
        frozenset({SCALE_VALUES.address}),
        advice=lambda ratio: f"scale the current (CURRENT_CONF) and lower SCALE_VALUES to {ratio:.3g} of what they are",
    )
