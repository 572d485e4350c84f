"""Every register of a TMC5xxx that holds a velocity, an acceleration or a time, there and back.

Sources: as in `sixpoint_registers` and `tmc5xxx_times`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ...number_text import plain
from ..ramps import sixpoint_registers as ramp
from ..ramps.sixpoint_registers import Kind
from ..tmc5xxx.chips import CHIPS
from . import tmc5xxx_times as times
from .tmc5xxx import CLOCK_HZ, VELOCITY_MAX, clock_of, velocity_unit_pps

MODELS = tuple(CHIPS)


@dataclass(frozen=True)
class Format:
    """How a register counts.

    least : the step from one value to the next, and the smallest above 0; highest : the greatest [`kind`]
    to_raw : the nearest whole number of a value; raises ValueError for one that the register cannot hold
    from_raw : what a whole number stands for; raises ValueError outside of the register
    rising : of a threshold on TSTEP, where it switches as the motor speeds up; else None
    """

    name: str
    kind: Kind
    least: float
    highest: float
    to_raw: Callable[[float], int]
    from_raw: Callable[[int], float]
    rising: Callable[[int], float] | None = None


def formats(
    model: str, clock_hz: float = CLOCK_HZ, microsteps: int = 256, small_hysteresis: bool = False
) -> dict[str, Format]:
    """The registers of a chip by name, in the order of addresses.

    microsteps : of a full step, in which velocities count, for the thresholds on TSTEP; small_hysteresis : as in GCONF
    Raises ValueError for another chip, a clock or a resolution that cannot be.
    """
    if model not in MODELS:
        raise ValueError(f"model is one of {', '.join(MODELS)}, not {model}")
    chip = CHIPS[model]
    registers = ramp.EIGHT_POINT if chip.eight_point else ramp.REGISTERS
    moving = [_ramp(name, clock_hz, registers) for name in registers]
    rows = [_hold_delay(clock_hz)]
    if chip.one_axis:
        rows.append(_power_down(clock_hz, chip.first_free))
        names = ("TPWMTHRS", "TCOOLTHRS", "THIGH")
        rows += [_threshold(name, clock_hz, microsteps, small_hysteresis) for name in names]
        rows += moving
    else:
        rows = [*moving, *rows, *(_velocity(name, clock_hz) for name in ("VCOOLTHRS", "VHIGH"))]
    if chip.dcstep:
        rows.append(_velocity("VDCMIN", clock_hz))
    return {row.name: row for row in rows}


def _ramp(name: str, clock_hz: float, registers: ramp.Registers) -> Format:
    held, unit = registers[name], ramp.unit_of(name, clock_hz)
    return Format(
        name,
        held.unit,
        unit,
        held.most * unit,
        lambda value: ramp.to_raw(name, value, clock_hz, registers),
        lambda raw: ramp.from_raw(name, raw, clock_hz, registers),
    )


def _velocity(name: str, clock_hz: float) -> Format:
    """A threshold in velocity units, whose lowest bits do not count."""
    unit, most = velocity_unit_pps(clock_hz), VELOCITY_MAX // times.THRESHOLD_STEP * times.THRESHOLD_STEP

    def from_raw(raw: int) -> float:
        if not 0 <= raw < 1 << 23:
            raise ValueError(f"{name} is 0 to {(1 << 23) - 1}, got {raw}")
        return raw // times.THRESHOLD_STEP * times.THRESHOLD_STEP * unit

    return Format(
        name,
        "pps",
        times.THRESHOLD_STEP * unit,
        most * unit,
        lambda value: times.velocity_threshold(value, clock_hz),
        from_raw,
    )


def _threshold(name: str, clock_hz: float, microsteps: int, small_hysteresis: bool) -> Format:
    """A threshold on TSTEP: the lowest velocity is the greatest number, and 0 a velocity that no motor gets to."""

    def at(raw: int) -> times.Threshold:
        return times.threshold(raw, microsteps, clock_hz, small_hysteresis)

    highest, lowest = at(1).falling_pps, at(times.TSTEP_MAX).falling_pps

    def to_raw(value: float) -> int:
        if not value >= 0:  # also false for NaN
            raise ValueError(f"a threshold is not below 0 pps, got {plain(value)}")
        if value > highest:
            raise ValueError(f"{name} is up to {plain(highest)} pps (one clock a step), got {plain(value)}")
        return times.TSTEP_MAX if value <= lowest else int(highest / value + 0.5)

    return Format(name, "pps", lowest, highest, to_raw, lambda raw: at(raw).falling_pps, lambda raw: at(raw).rising_pps)


def _power_down(clock_hz: float, first_free: bool) -> Format:
    return Format(
        "TPOWERDOWN",
        "s",
        times.DELAY_CLOCKS / clock_of(clock_hz),
        times.power_down_s(times.POWER_DOWN_MAX, clock_hz, first_free),
        lambda value: times.power_down(value, clock_hz, first_free),
        lambda raw: times.power_down_s(raw, clock_hz, first_free),
    )


def _hold_delay(clock_hz: float) -> Format:
    """One step of the current's way down."""
    return Format(
        "IHOLDDELAY",
        "s",
        times.DELAY_CLOCKS / clock_of(clock_hz),
        times.hold_delay_s(times.HOLD_DELAY_MAX, 1, clock_hz),
        lambda value: times.hold_delay(value, 1, clock_hz),
        lambda raw: times.hold_delay_s(raw, 1, clock_hz),
    )
