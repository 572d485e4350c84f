"""What moves an axis: its ramp parameters, read in one turn, judged before anything is started."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...calc.ramps import ticked
from ...errors import CannotMove, OutOfRange
from ...registers.model import Register, to_signed
from ..core.register_io import RegisterIO
from .axis_roles import HOLD_MODE, VELOCITY_MODE, AxisRoles

MODE_NAMES = ("ramp", "soft", "velocity", "hold")
"""The calculators' names of the ramp modes, by number."""
POSITION_MIN, POSITION_MAX = -(1 << 23), (1 << 23) - 1
DISTANCE_MAX = (1 << 23) - 1
"""|x_target - x_actual| has to be less than 2^23, else the motor goes the other way round (DS-TMC428 8.1)."""
P_MUL_FIRST = 128
"""p_mul of pmul 0: the mantissa's leading one is fixed (DS-TMC428 8.10)."""


@dataclass(slots=True)
class RampParameters:
    """The registers of one axis that decide a motion, as values."""

    reference: int
    v_min: int
    v_max: int
    a_max: int
    p_mul: int
    """128..255."""
    pdiv: int
    pulse_div: int
    ramp_div: int
    mode: int

    @classmethod
    def rows(cls, rows: AxisRoles) -> tuple[Register, ...]:
        """What has to be read for ramp parameters, in order."""
        return (rows.reference, rows.v_min, rows.v_max, rows.a_max, rows.proportionality, rows.dividers)

    @classmethod
    def of(cls, rows: AxisRoles, words: Mapping[int, int]) -> RampParameters:
        """From register words by address."""
        reference, dividers = words[rows.reference.address], words[rows.dividers.address]
        pair = words[rows.proportionality.address]
        return cls(
            reference=reference,
            v_min=rows.v_min.decode(words[rows.v_min.address]),
            v_max=rows.v_max.decode(words[rows.v_max.address]),
            a_max=rows.a_max.decode(words[rows.a_max.address]),
            p_mul=rows.pmul.unpack(pair) | P_MUL_FIRST,
            # Above 13 a divider has no meaning in the sheets; a chip that holds one anyway is taken at 13.
            pdiv=min(rows.pdiv.unpack(pair), 13),
            pulse_div=min(rows.pulse_div.unpack(dividers), 13),
            ramp_div=min(rows.ramp_div.unpack(dividers), 13),
            mode=rows.mode.unpack(reference),
        )

    @classmethod
    async def read(cls, io: RegisterIO, rows: AxisRoles) -> RampParameters:
        return cls.of(rows, {register.address: await io.read(register) for register in cls.rows(rows)})

    @property
    def p(self) -> float:
        """The proportionality factor (DS-TMC428 8.10)."""
        return float(self.p_mul / 2 ** (3 + self.pdiv))

    @property
    def p_ideal(self) -> float:
        """The largest p without overshoot, but for rounding (DS-TMC428 8.11)."""
        return float(self.a_max / (128 * 2.0 ** (self.ramp_div - self.pulse_div)))

    def parameters(
        self, clock_hz: float, mode: int, v_target: int = 0, v_actual: int | None = None
    ) -> ticked.RampParameters:
        """For the calculators."""
        return ticked.RampParameters(
            v_min=self.v_min,
            v_max=self.v_max,
            a_max=self.a_max,
            ramp_div=self.ramp_div,
            pulse_div=self.pulse_div,
            pmul=self.p_mul - P_MUL_FIRST,
            pdiv=self.pdiv,
            ramp_mode=MODE_NAMES[mode],
            clock_hz=clock_hz,
            v_target=v_target if mode == VELOCITY_MODE else None,
            v_actual=v_actual if mode == HOLD_MODE else None,
        )

    def require_motion(self, axis: int) -> None:
        """Raises CannotMove where no command can move the motor."""
        if self.v_max == 0:
            raise CannotMove(f"axis {axis} cannot move: v_max is 0", "write v_max, 1..2047", axis)
        if self.a_max == 0:
            raise CannotMove(
                f"axis {axis} cannot change its speed: a_max is 0",
                "write a_max, 1..2047, and a matching pmul and pdiv",
                axis,
            )

    def require_proportionality(self, axis: int) -> None:
        """Raises CannotMove where pmul and pdiv were plainly never set."""
        if self.p_mul == P_MUL_FIRST and self.pdiv == 0 and self.p > self.p_ideal:
            raise CannotMove(
                f"axis {axis} would swing around its target: pmul and pdiv are as after power-on, p = {self.p:g}"
                f" where a_max and the dividers want {self.p_ideal:.4g} at most",
                "design a pair (POST /calc/pmul-pdiv) and write it first",
                axis,
            )

    def proportionality_warnings(self) -> list[str]:
        """What a p that does not fit the acceleration will do to a move."""
        ideal = self.p_ideal
        if self.p > ideal:
            return [f"p is {self.p:.4g}, above the {ideal:.4g} that a_max and the dividers allow: it may overshoot"]
        if self.p < 0.5 * ideal:
            return [f"p is {self.p:.4g}, less than half the {ideal:.4g} possible: the approach is slow"]
        return []

    def blocked(self, rows: AxisRoles, direction: int, left: bool | None, right: bool | None) -> str:
        """The name of the switch that keeps the motor from that direction, or ""."""
        if direction < 0 and left and not rows.stop_left_off.unpack(self.reference):
            return "left"
        if direction > 0 and right and not rows.stop_right_off.unpack(self.reference):
            return "right"
        return ""


def distance(x_target: int, x_actual: int) -> int:
    """x_target - x_actual as the chip's 24 bits make it, -2^23..2^23-1 [microsteps]."""
    return to_signed((x_target - x_actual) & 0xFF_FFFF, 24)


def checked_target(axis: int, target: int, x_actual: int, shown: str = "") -> int:
    """`target` [microsteps]. Raises OutOfRange outside 24 bits, or too far for one move."""
    if not POSITION_MIN <= target <= POSITION_MAX:
        raise OutOfRange(f"target of axis {axis}", target, POSITION_MIN, POSITION_MAX, f"microsteps{shown}")
    if abs(target - x_actual) > DISTANCE_MAX:
        raise OutOfRange(
            f"distance of axis {axis}",
            target - x_actual,
            -DISTANCE_MAX,
            DISTANCE_MAX,
            "microsteps; farther, the chip would take the other way round: go in two moves",
        )
    return target
