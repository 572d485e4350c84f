"""What the registers of a TMC5xxx make of units and ramps: from the contract to the calculators and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ...calc.ramps import sixpoint_registers
from ...calc.ramps.sixpoint import SixPoint
from ...calc.units.tmc5xxx import CLOCK_HZ
from ...calc.units.tmc5xxx_registers import MODELS, Format, formats
from ...calc.units.tmc5xxx_times import tstep
from ...errors import UsageError
from .ramp_parameters import check_names, number_of
from .schemas import Ramp, Units
from .sixpoint_schemas import HeldRegister, SixPointUnits
from .sramp_schemas import RampFinding, RampRegister

__all__ = ["MODELS", "ramp_findings", "ramp_registers", "sixpoint_units", "sixpoint_wish"]


def sixpoint_units(body: Units, velocity_pps: float | None, acceleration_pps2: float | None) -> SixPointUnits:
    """Raises UsageError for a register that the chip has not, ValueError for numbers that cannot be."""
    microsteps = body.mechanics.microsteps_per_full_step
    known = formats(body.model, body.clock_hz, microsteps, body.small_hysteresis)
    wanted = {
        "pps": None if velocity_pps is None else abs(velocity_pps),
        "pps^2": None if acceleration_pps2 is None else abs(acceleration_pps2),
        "s": body.delay_s,
    }
    given = body.registers or {}
    for name in given:
        if name not in known:
            raise UsageError(f"a {body.model} has no such register {name!r} here; known: {', '.join(known)}")
    return SixPointUnits(
        registers=[_held(form, value) for form in known.values() if (value := wanted[form.kind]) is not None],
        tstep=None if velocity_pps is None else tstep(velocity_pps, microsteps, body.clock_hz),
        given=[_standing(known[name], raw) for name, raw in given.items()],
    )


def _held(form: Format, value: float) -> HeldRegister:
    try:
        raw = form.to_raw(value)
    except ValueError as error:
        return _row(form, None, str(error))
    row = _row(form, raw)
    if value and row.value is not None:
        row.error = row.value / value - 1
    return row


def _standing(form: Format, raw: int) -> HeldRegister:
    return _row(form, raw)


def _row(form: Format, raw: int | None, note: str = "") -> HeldRegister:
    return HeldRegister(
        name=form.name,
        raw=raw,
        value=None if raw is None else _finite(form.from_raw(raw)),
        rising=None if raw is None or form.rising is None else _finite(form.rising(raw)),
        unit=form.kind,
        least=form.least,
        highest=form.highest,
        note=note or ("never reached" if raw == 0 and form.rising is not None else ""),
    )


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


PARAMETERS = {
    "vstart": "v_start",
    "a1": "a1",
    "v1": "v1",
    "amax": "a_max",
    "vmax": "v_max",
    "dmax": "d_max",
    "d1": "d1",
    "vstop": "v_stop",
    "t_zero_wait_s": "t_zero_wait_s",
    "v2": "v2",
    "a2": "a2",
    "d2": "d2",
    "t_vmax_s": "t_v_max_s",
}
"""The contract's names of a SixPoint ramp's parameters, and the calculator's."""
EIGHT_POINTS = ("v2", "a2", "d2", "t_vmax_s")
"""Where one of them is given, the ramp is that of a chip which has them."""
STATE = ("v_actual", "v_target", "clock_hz")
CHOICES = {"ramp_mode": ("ramp", "velocity"), "rounding": ("none", "registers")}


@dataclass(frozen=True)
class RampRequest:
    """A request for a SixPoint ramp, understood. held : what of it goes into registers, D1 never left at 0."""

    ramp: SixPoint
    held: SixPoint
    clock_hz: float
    positioning: bool
    v_actual: float
    v_target: float
    registers: sixpoint_registers.Registers


def sixpoint_wish(body: Ramp) -> RampRequest:
    """Raises UsageError for names and kinds, ValueError for numbers that cannot be."""
    given = dict(body.parameters)
    registers = sixpoint_registers.EIGHT_POINT if given.keys() & set(EIGHT_POINTS) else sixpoint_registers.REGISTERS
    chosen = {name: given.pop(name, among[0]) for name, among in CHOICES.items()}
    for name, among in CHOICES.items():
        if chosen[name] not in among:
            raise UsageError(f"{name} of a sixpoint ramp is {' or '.join(among)}, not {chosen[name]!r}")
    check_names(given, (*PARAMETERS, *STATE), ("amax", "vmax"), tuple(CHOICES))
    numbers = {name: number_of(name, value) for name, value in given.items()}
    clock_hz = numbers.pop("clock_hz", CLOCK_HZ)
    v_actual = numbers.pop("v_actual", 0.0)
    v_target = numbers.pop("v_target", math.copysign(numbers["vmax"], body.distance))
    positioning = chosen["ramp_mode"] == "ramp"
    whole = {"dmax": numbers["amax"], **numbers}
    whole = {"a1": numbers["amax"], "d1": whole["dmax"], **whole}
    if registers is sixpoint_registers.EIGHT_POINT:
        whole = {"a2": numbers["amax"], "d2": whole["dmax"], **whole}
    if positioning:
        numbers = whole if whole.get("v1") or whole.get("v2") else {"dmax": whole["dmax"], **numbers}
    ramp, held = _of(numbers), _of(whole)
    if chosen["rounding"] == "registers":
        ramp = sixpoint_registers.held(ramp, clock_hz, registers)
    return RampRequest(ramp, held, clock_hz, positioning, v_actual, v_target, registers)


def _of(numbers: Mapping[str, float]) -> SixPoint:
    return SixPoint(**{PARAMETERS[name]: number for name, number in numbers.items()})


def ramp_registers(wish: RampRequest) -> list[RampRegister]:
    """What a ramp becomes in its registers. Raises ValueError for what they cannot hold."""
    raw = sixpoint_registers.registers_of(wish.held, wish.clock_hz, wish.registers)
    found = []
    for name, held in wish.registers.items():
        unit = sixpoint_registers.unit_of(name, wish.clock_hz)
        parameter = next(own for own, calculator in PARAMETERS.items() if calculator == held.parameter)
        found.append(
            RampRegister(
                parameter=parameter,
                name=name,
                raw=raw[name],
                value=raw[name] * unit,
                least=unit,
                highest=held.most * unit,
                why_highest=held.why,
                unit=held.unit,
            )
        )
    return found


def ramp_findings(wish: RampRequest) -> list[RampFinding]:
    """What the data sheets warn of."""
    raw = sixpoint_registers.registers_of(wish.held, wish.clock_hz, wish.registers)
    names = {name: held.parameter for name, held in wish.registers.items()}
    own = {calculator: parameter for parameter, calculator in PARAMETERS.items()}
    return [
        RampFinding(code=finding.code, parameter=own[names[finding.register]], text=finding.text)
        for finding in sixpoint_registers.findings(raw, wish.positioning)
    ]
