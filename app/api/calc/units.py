"""Units of one axis, every one of what is given: a chip's, a module's, and those of people."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeVar

from ...calc.units import mechanics
from ...calc.units import tmc5xxx as tmc5xxx_units
from ...calc.units import tmc428 as chip_units
from ...calc.units import tmc4361 as tmc4361_formats
from ...calc.units.tmc5xxx_times import tstep
from ...errors import UsageError
from ...registers.tmcl.modules import MODULES
from ..devices.views import calculating
from .schemas import Mechanics, ModuleUnits, Quantity, RampUnits, Units, UnitsResult
from .sixpoint import MODELS as SIXPOINT
from .sixpoint import sixpoint_units

VELOCITY_UNITS = {
    "pps": "pps",
    "fullsteps_per_s": "fullsteps/s",
    "rps": "rps",
    "rpm": "rpm",
    "rad_per_s": "rad/s",
    "mm_per_s": "mm/s",
}
ACCELERATION_UNITS = {
    "pps2": "pps^2",
    "fullsteps_per_s2": "fullsteps/s^2",
    "rps2": "rps^2",
    "rpm_per_s": "rpm/s",
    "rad_per_s2": "rad/s^2",
    "mm_per_s2": "mm/s^2",
}
"""The contract's names of units, and the calculators'."""
BOW_UNITS = {
    "pps3": "pps^2",
    "fullsteps_per_s3": "fullsteps/s^2",
    "rps3": "rps^2",
    "rpm_per_s2": "rpm/s",
    "rad_per_s3": "rad/s^2",
    "mm_per_s3": "mm/s^2",
}
"""The mechanics knows no unit of a jerk; from microsteps to millimetres it is as far as with an acceleration."""
CHIP = "chip"
SIXPOINT_INSIDE = frozenset(name for name, module in MODULES.items() if module.counting == "unit mode")
"""Modules whose ramp generator is a TMC5160's."""

N = TypeVar("N", int, float)


@dataclass(frozen=True, slots=True)
class _Scale:
    """How a model counts: its own units to pps and pps^2 and back. Each raises ValueError beyond its registers."""

    to_pps: Callable[[float], float]
    from_pps: Callable[[float], float]
    to_pps2: Callable[[float], float]
    from_pps2: Callable[[float], float]


def _ramp_scale(units: tmc4361_formats.Units) -> _Scale:
    velocity, acceleration = units.least("VMAX"), units.least("AMAX")
    return _Scale(
        lambda value: value * velocity,
        lambda pps: pps / velocity,
        lambda value: value * acceleration,
        lambda pps2: pps2 / acceleration,
    )


def _scale(body: Units) -> _Scale:
    if body.model in (*SIXPOINT_INSIDE, *SIXPOINT):
        return _Scale(
            lambda value: tmc5xxx_units.velocity_pps(value, body.clock_hz),
            lambda pps: pps / tmc5xxx_units.velocity_unit_pps(body.clock_hz),
            lambda value: tmc5xxx_units.acceleration_pps2(value, body.clock_hz),
            lambda pps2: pps2 / tmc5xxx_units.acceleration_unit_pps2(body.clock_hz),
        )
    if body.model == "tmc4361":
        return _ramp_scale(_ramp_units(body))
    pulse_div, ramp_div, clock_hz = body.pulse_div, body.ramp_div, body.clock_hz
    if pulse_div is None or ramp_div is None:
        raise UsageError(f"a {body.model} counts by pulse_div and ramp_div, and one of them is missing")
    return _Scale(
        lambda value: chip_units.pulse_rate_hz(value, pulse_div, clock_hz),
        lambda pps: chip_units.velocity_from_rate(pps, pulse_div, clock_hz),
        lambda value: chip_units.acceleration_hz_s(value, pulse_div, ramp_div, clock_hz),
        lambda pps2: chip_units.acceleration_from_hz_s(pps2, pulse_div, ramp_div, clock_hz),
    )


def units(body: Units) -> UnitsResult:
    axis = mechanics_of(body.mechanics)
    if body.bow is not None and body.model != "tmc4361":
        raise UsageError(f"a {body.model} has no bows; a tmc4361 has")
    if body.model not in SIXPOINT and (body.delay_s is not None or body.registers is not None):
        raise UsageError(f"delay_s and registers are for {', '.join(SIXPOINT)}, not a {body.model}")
    with calculating():
        scale = _scale(body)
    velocity_pps = acceleration_pps2 = bow_pps3 = None
    velocity = acceleration = position = bow = None
    with calculating():
        if body.velocity is not None:
            velocity_pps = _from(body.velocity, axis, VELOCITY_UNITS, scale.to_pps)
            velocity = _all_units(velocity_pps, axis, VELOCITY_UNITS)
            velocity[CHIP] = _or_none(scale.from_pps, velocity_pps)
        if body.acceleration is not None:
            acceleration_pps2 = _from(body.acceleration, axis, ACCELERATION_UNITS, scale.to_pps2)
            acceleration = _all_units(acceleration_pps2, axis, ACCELERATION_UNITS)
            acceleration[CHIP] = _or_none(scale.from_pps2, acceleration_pps2)
        if body.bow is not None:
            one = _ramp_units(body).least("BOW1")
            bow_pps3 = _from(body.bow, axis, BOW_UNITS, lambda value: value * one)
            bow = _all_units(bow_pps3, axis, BOW_UNITS)
            bow[CHIP] = bow_pps3 / one
        if body.position is not None:
            known = dict(zip(mechanics.POSITION_UNITS, mechanics.POSITION_UNITS, strict=True))
            microsteps = axis.to_microsteps(body.position.value, unit_of(body.position, known))
            position = _all_units(microsteps, axis, known)
        sixpoint = sixpoint_units(body, velocity_pps, acceleration_pps2) if body.model in SIXPOINT else None
    steps = time_s = None
    if velocity_pps is not None and acceleration_pps2:
        # From rest at a constant acceleration: S = v^2 / 2a (DS-TMC428 8.14 in chip units).
        steps = velocity_pps**2 / (2 * abs(acceleration_pps2))
        time_s = abs(velocity_pps / acceleration_pps2)
    return UnitsResult(
        velocity=velocity,
        acceleration=acceleration,
        position=position,
        acceleration_steps=steps,
        acceleration_time_s=time_s,
        module=_module(body, velocity_pps, acceleration_pps2) if body.model in SIXPOINT_INSIDE else None,
        bow=bow,
        ramp=_ramp(body, velocity_pps, acceleration_pps2, bow_pps3) if body.model == "tmc4361" else None,
        sixpoint=sixpoint,
    )


def _ramp_units(body: Units) -> tmc4361_formats.Units:
    """Raises ValueError for a clock that the chip cannot have."""
    return tmc4361_formats.Units(body.clock_hz, body.direct_acceleration, body.direct_bow)


def _ramp(body: Units, velocity: float | None, acceleration: float | None, bow: float | None) -> RampUnits:
    """What the registers of a TMC4361 get; null, and the limit by its name, for what they cannot hold."""
    units, limits = _ramp_units(body), list[str]()

    def held(register: str, value: float | None) -> tuple[int | None, float | None]:
        if value is None:
            return None, None
        try:
            raw = units.to_raw(register, value)
        except ValueError as error:
            limits.append(str(error))
            return None, None
        limits.extend(units.warnings(register, value, positioning=register == "VMAX"))
        return raw, units.from_raw(register, raw)

    vmax, vmax_pps = held("VMAX", velocity)
    amax, amax_pps2 = held("AMAX", acceleration)
    raw_bow, bow_pps3 = held("BOW1", bow)
    return RampUnits(
        velocity=vmax,
        velocity_pps=vmax_pps,
        acceleration=amax,
        acceleration_pps2=amax_pps2,
        bow=raw_bow,
        bow_pps3=bow_pps3,
        limits=limits,
    )


def _module(body: Units, velocity_pps: float | None, acceleration_pps2: float | None) -> ModuleUnits:
    """What the registers of the TMC5160 get; null for what they cannot hold."""
    clock_hz, microsteps = body.clock_hz, body.mechanics.microsteps_per_full_step
    velocity = None if velocity_pps is None else _or_none(tmc5xxx_units.velocity_units, velocity_pps, clock_hz)
    acceleration = (
        None if acceleration_pps2 is None else _or_none(tmc5xxx_units.acceleration_units, acceleration_pps2, clock_hz)
    )
    return ModuleUnits(
        velocity=velocity,
        velocity_pps=None if velocity is None else tmc5xxx_units.velocity_pps(velocity, clock_hz),
        acceleration=acceleration,
        acceleration_pps2=None if acceleration is None else tmc5xxx_units.acceleration_pps2(acceleration, clock_hz),
        tstep=None if velocity_pps is None else _or_none(tstep, velocity_pps, microsteps, clock_hz),
    )


def mechanics_of(body: Mechanics) -> mechanics.Mechanics:
    """Raises ValueError for what cannot be."""
    return mechanics.Mechanics(
        body.full_steps_per_rev, body.microsteps_per_full_step, body.gear_ratio, body.travel_mm_per_rev
    )


def unit_of(quantity: Quantity, known: Mapping[str, str]) -> str:
    """The calculators' name of a unit. Raises UsageError for one that is not in `known`."""
    unit = known.get(quantity.unit)
    if unit is None:
        raise UsageError(f"unit {quantity.unit!r} is not one of {', '.join(known)}")
    return unit


def _from(
    quantity: Quantity, axis: mechanics.Mechanics, names: Mapping[str, str], own: Callable[[float], float]
) -> float:
    if quantity.unit == CHIP:
        return own(quantity.value)
    return axis.to_microsteps(quantity.value, unit_of(quantity, {**names, CHIP: CHIP}))


def _all_units(microsteps: float, axis: mechanics.Mechanics, names: Mapping[str, str]) -> dict[str, float | None]:
    """The number in every unit; null for millimetres on an axis that does not move any."""
    return {
        name: None
        if unit.startswith("mm") and axis.travel_mm_per_rev is None
        else axis.from_microsteps(microsteps, unit)
        for name, unit in names.items()
    }


def _or_none(convert: Callable[..., N], *numbers: float) -> N | None:
    """A register value, or None where no register value gives that much."""
    try:
        return convert(*numbers)
    except ValueError:
        return None
