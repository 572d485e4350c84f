"""From the shapes of the contract to the calculators and back. The formulas are in app/calc, none is here."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from app.api.convert import built_chain, calculating, chain_table
from app.api.schemas_calc import (
    ChainRequest,
    Mechanics,
    MicrostepDesign,
    MicrostepMetrics,
    MicrostepResult,
    Phase,
    PmulPdiv,
    PmulPdivCandidate,
    PmulPdivResult,
    Quantity,
    Ramp,
    RampInverse,
    RampInverseResult,
    RampResult,
    SequencerRow,
    Units,
    UnitsResult,
)
from app.api.schemas_tables import ChainBit, ChainDesign
from app.calc import mechanics, pmul_pdiv_inverse
from app.calc import microstep_table as tables
from app.calc import pmul_pdiv as pairs
from app.calc import units as chip_units
from app.calc.driver_chain import chain_frequencies
from app.calc.ramp import RampParameters, exact_ramp
from app.calc.ramp_curve import RampCurve
from app.calc.ramp_trapezoid import trapezoid_ramp
from app.links.errors import UsageError

VELOCITY_UNITS = {
    "pps": "pps",
    "fullsteps_per_s": "fullsteps/s",
    "rpm": "rpm",
    "rad_per_s": "rad/s",
    "mm_per_s": "mm/s",
}
ACCELERATION_UNITS = {
    "pps2": "pps^2",
    "fullsteps_per_s2": "fullsteps/s^2",
    "rpm_per_s": "rpm/s",
    "rad_per_s2": "rad/s^2",
    "mm_per_s2": "mm/s^2",
}
"""The contract's names of units, and the calculators'."""
CHIP = "chip"


def pmul_pdiv(body: PmulPdiv) -> PmulPdivResult:
    with calculating():
        design = pairs.design(
            body.chip,
            body.a_max,
            body.ramp_div,
            body.pulse_div,
            body.reduction,
            v_max=body.v_max,
            v_min=body.v_min,
            clock_hz=body.clock_hz,
        )
    return PmulPdivResult(
        p_ideal=design.p_ideal,
        p_reduced=design.p_reduced,
        pmul=design.pmul,
        p_mul=design.p_mul,
        pdiv=design.pdiv,
        p=design.p,
        quality=design.quality,
        candidates=[PmulPdivCandidate.model_validate(candidate) for candidate in design.candidates],
        a_max_lower_limit=design.a_max_lower_limit,
        a_max_upper_limit=design.a_max_upper_limit,
        warnings=list(design.warnings),
    )


def units(body: Units) -> UnitsResult:
    axis = _mechanics(body.mechanics)
    velocity_pps = acceleration_pps2 = None
    velocity = acceleration = position = None
    with calculating():
        if body.velocity is not None:
            velocity_pps = _velocity_pps(body.velocity, axis, body.pulse_div, body.clock_hz)
            velocity = _all_units(velocity_pps, axis, VELOCITY_UNITS)
            velocity[CHIP] = _or_none(chip_units.velocity_from_rate, velocity_pps, body.pulse_div, body.clock_hz)
        if body.acceleration is not None:
            acceleration_pps2 = _acceleration_pps2(
                body.acceleration, axis, body.pulse_div, body.ramp_div, body.clock_hz
            )
            acceleration = _all_units(acceleration_pps2, axis, ACCELERATION_UNITS)
            acceleration[CHIP] = _or_none(
                chip_units.acceleration_from_hz_s, acceleration_pps2, body.pulse_div, body.ramp_div, body.clock_hz
            )
        if body.position is not None:
            known = dict(zip(mechanics.POSITION_UNITS, mechanics.POSITION_UNITS, strict=True))
            microsteps = axis.to_microsteps(body.position.value, _unit(body.position, known))
            position = _all_units(microsteps, axis, known)
    steps = time_s = None
    if velocity_pps is not None and acceleration_pps2:
        # From rest at a constant acceleration: S = v^2 / 2a (001, 8.14 in chip units).
        steps = velocity_pps**2 / (2 * abs(acceleration_pps2))
        time_s = abs(velocity_pps / acceleration_pps2)
    return UnitsResult(
        velocity=velocity,
        acceleration=acceleration,
        position=position,
        acceleration_steps=steps,
        acceleration_time_s=time_s,
    )


def ramp(body: Ramp) -> RampResult:
    with calculating():
        curve = _trapezoid(body) if body.model == "trapezoid" else _exact(body)
    return RampResult(
        duration_s=curve.duration_s,
        phases=[Phase.model_validate(phase) for phase in curve.phases],
        time_s=curve.time_s.tolist(),
        position=curve.position.tolist(),
        velocity_pps=curve.velocity_pps.tolist(),
        acceleration_pps2=curve.acceleration_pps2.tolist(),
        overshoot_steps=curve.overshoot_steps,
        warnings=[] if curve.settled or _open_ended(body) else ["the motor does not rest at the target at the end"],
    )


def ramp_inverse(body: RampInverse) -> RampInverseResult:
    with calculating():
        found = pmul_pdiv_inverse.inverse(
            body.model,
            body.velocity.value,
            body.acceleration.value,
            _mechanics(body.mechanics),
            body.clock_hz,
            velocity_unit=_unit(body.velocity, VELOCITY_UNITS),
            acceleration_unit=_unit(body.acceleration, ACCELERATION_UNITS),
            reduction=body.reduction,
        )
    return RampInverseResult.model_validate(found)


def microstep_table(body: MicrostepDesign) -> MicrostepResult:
    with calculating():
        warnings: list[str] = []
        if body.values is not None:
            values = tables.checked_values(body.values)
        else:
            amplitude = {} if body.amplitude is None else {"amplitude": body.amplitude}
            design = tables.design_table(
                body.sigma, body.offset, **amplitude, method=body.method, full_scale=body.full_scale
            )
            values, warnings = design.values, list(design.warnings)
        metrics = tables.metrics(values, body.usrs)
        sequence = tables.step_through(values, body.usrs)
        datagrams = tables.table_datagrams(values)
    return MicrostepResult(
        values=list(values),
        datagrams=[f"{datagram:08x}" for datagram in datagrams],
        metrics=_metrics(metrics),
        sequence=[_sequencer_row(step) for step in sequence],
        warnings=warnings,
    )


def driver_chain(body: ChainRequest) -> ChainDesign:
    chain = built_chain(body.drivers)
    with calculating():
        frequencies = chain_frequencies(chain, body.clock_hz, body.clk2_div, body.ramp_divs)
    table = chain_table(chain.ram_words, chain.lsmd)
    findings = [*dict.fromkeys((*table.findings, *chain.warnings, *frequencies.warnings))]
    return ChainDesign(
        **table.model_dump(exclude={"findings", "bits"}),
        bits=[
            ChainBit.model_validate(bit) for bit in chain.bits
        ],  # with the names of custom drivers, which no RAM keeps
        findings=findings,
        datagrams=[f"{datagram:08x}" for datagram in chain.datagrams],
        spi_clock_hz=frequencies.spi_clock_hz,
        datagram_hz=frequencies.datagram_hz,
        continuous_update_hz=frequencies.continuous_update_hz,
        full_step_hz_max=frequencies.full_step_max_hz,
    )


# --- the ramp's parameters ----------------------------------------------------------------------

WHOLE = ("v_min", "v_max", "a_max", "ramp_div", "pulse_div", "pmul", "pdiv", "v_target", "v_actual")
NEEDED = ("v_max", "a_max", "ramp_div", "pulse_div")


def _trapezoid(body: Ramp) -> RampCurve:
    names = ("vmax", "amax", "dmax")
    given = dict(body.parameters)
    given.setdefault("dmax", given.get("amax", 0.0))
    _check_names(given, names, names)
    vmax, amax, dmax = (_number(name, given[name]) for name in names)
    return trapezoid_ramp(vmax, amax, dmax, body.distance, body.samples)


def _exact(body: Ramp) -> RampCurve:
    given = dict(body.parameters)
    mode = given.pop("ramp_mode", "ramp")
    clock_hz = given.pop("clock_hz", 16e6)
    if not isinstance(mode, str) or isinstance(clock_hz, str):
        raise UsageError("ramp_mode is a name, clock_hz a number")
    _check_names(given, WHOLE, NEEDED, ("ramp_mode", "clock_hz"))
    numbers = {name: _whole(name, value) for name, value in given.items()}
    if mode in ("ramp", "soft") and not {"pmul", "pdiv"} <= numbers.keys():
        raise UsageError(f"pmul and pdiv decide when {mode} mode brakes, and are missing")
    distance = _whole("distance", body.distance)
    # Where nobody says how fast it is to turn: at v_max, the way that the distance says.
    full_speed = numbers["v_max"] if distance >= 0 else -numbers["v_max"]
    if mode == "velocity":
        numbers.setdefault("v_target", full_speed)
    if mode == "hold":
        numbers.setdefault("v_actual", full_speed)
    parameters = RampParameters(**{"v_min": 1, **numbers}, ramp_mode=mode, clock_hz=clock_hz)
    return exact_ramp(parameters, distance, body.samples)


def _check_names(
    given: Mapping[str, object], known: tuple[str, ...], needed: tuple[str, ...], others: tuple[str, ...] = ()
) -> None:
    unknown = [name for name in given if name not in known]
    missing = [name for name in needed if name not in given]
    if unknown:
        raise UsageError(f"there is no parameter {unknown[0]!r}; known: {', '.join((*known, *others))}")
    if missing:
        raise UsageError(f"missing parameters: {', '.join(missing)}")


def _number(name: str, value: float | str) -> float:
    if isinstance(value, str):
        raise UsageError(f"{name} is a number, not {value!r}")
    return value


def _whole(name: str, value: float | str) -> int:
    if isinstance(value, str) or value != int(value):
        raise UsageError(f"{name} is a whole number, not {value!r}")
    return int(value)


def _open_ended(body: Ramp) -> bool:
    return body.parameters.get("ramp_mode") in ("velocity", "hold")


# --- units --------------------------------------------------------------------------------------


def _mechanics(body: Mechanics) -> mechanics.Mechanics:
    return mechanics.Mechanics(
        body.full_steps_per_rev, body.microsteps_per_full_step, body.gear_ratio, body.travel_mm_per_rev
    )


def _unit(quantity: Quantity, known: Mapping[str, str]) -> str:
    unit = known.get(quantity.unit)
    if unit is None:
        raise UsageError(f"unit {quantity.unit!r} is not one of {', '.join(known)}")
    return unit


def _velocity_pps(quantity: Quantity, axis: mechanics.Mechanics, pulse_div: int, clock_hz: float) -> float:
    if quantity.unit == CHIP:
        return chip_units.pulse_rate_hz(quantity.value, pulse_div, clock_hz)
    return axis.to_microsteps(quantity.value, _unit(quantity, {**VELOCITY_UNITS, CHIP: CHIP}))


def _acceleration_pps2(
    quantity: Quantity, axis: mechanics.Mechanics, pulse_div: int, ramp_div: int, clock_hz: float
) -> float:
    if quantity.unit == CHIP:
        return chip_units.acceleration_hz_s(quantity.value, pulse_div, ramp_div, clock_hz)
    return axis.to_microsteps(quantity.value, _unit(quantity, {**ACCELERATION_UNITS, CHIP: CHIP}))


def _all_units(microsteps: float, axis: mechanics.Mechanics, names: Mapping[str, str]) -> dict[str, float | None]:
    """The number in every unit; null for millimetres on an axis that does not move any."""
    return {
        name: None
        if unit.startswith("mm") and axis.travel_mm_per_rev is None
        else axis.from_microsteps(microsteps, unit)
        for name, unit in names.items()
    }


def _or_none(convert: Callable[..., float], *numbers: float) -> float | None:
    """A register value, or None where no register value gives that much."""
    try:
        return convert(*numbers)
    except ValueError:
        return None


# --- tables -------------------------------------------------------------------------------------


def _metrics(metrics: tables.TableMetrics) -> MicrostepMetrics:
    largest, smallest = metrics.largest_step, metrics.smallest_step
    return MicrostepMetrics(
        vector_length_mean=metrics.vector_length_mean,
        vector_length_ripple=metrics.vector_length_ripple,
        angle_error_deg=list(metrics.angle_error_deg),
        angle_error_max_deg=metrics.angle_error_max_deg,
        angle_error_rms_deg=metrics.angle_error_rms_deg,
        harmonics=list(metrics.harmonics or ()),
        thd=metrics.thd,
        worst_step=None if largest is None else largest.step,
        worst_step_ratio=None if largest is None else largest.ratio,
        smallest_step_ratio=None if smallest is None else smallest.ratio,
    )


def _sequencer_row(step: tables.SequencerStep) -> SequencerRow:
    return SequencerRow(
        index=step.wave_index,
        current_a=step.current_a,
        current_b=step.current_b,
        ph_a=step.ph_a,
        ph_b=step.ph_b,
        fd_a=step.fd_a,
        fd_b=step.fd_b,
    )
