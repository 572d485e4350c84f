"""From the shapes of the contract to the calculators and back. The formulas are in app/calc, none is here.

Ramps and units have modules of their own.
"""

from __future__ import annotations

from ...calc.driver_chain.chain import chain_frequencies
from ...calc.microsteps import table as tables
from ...calc.ramps import pmul_pdiv as pairs
from ...calc.ramps import pmul_pdiv_inverse
from ..devices.views import built_chain, calculating
from ..tables.schemas import ChainBit, ChainDesign
from .schemas import (
    ChainRequest,
    MicrostepDesign,
    MicrostepMetrics,
    MicrostepResult,
    PmulPdiv,
    PmulPdivCandidate,
    PmulPdivResult,
    RampInverse,
    RampInverseResult,
    SequencerRow,
)
from .units import ACCELERATION_UNITS, VELOCITY_UNITS, mechanics_of, unit_of


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


def ramp_inverse(body: RampInverse) -> RampInverseResult:
    with calculating():
        found = pmul_pdiv_inverse.inverse(
            body.model,
            body.velocity.value,
            body.acceleration.value,
            mechanics_of(body.mechanics),
            body.clock_hz,
            velocity_unit=unit_of(body.velocity, VELOCITY_UNITS),
            acceleration_unit=unit_of(body.acceleration, ACCELERATION_UNITS),
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
    return ChainDesign(
        bits=[ChainBit.model_validate(bit) for bit in chain.bits],
        ram_words=list(chain.ram_cells),
        lsmd=chain.lsmd,
        length_bits=chain.length_bits,
        findings=[*dict.fromkeys((*chain.warnings, *frequencies.warnings))],
        datagrams=[f"{datagram:08x}" for datagram in chain.datagrams],
        spi_clock_hz=frequencies.spi_clock_hz,
        datagram_hz=frequencies.datagram_hz,
        continuous_update_hz=frequencies.continuous_update_hz,
        full_step_hz_max=frequencies.full_step_max_hz,
    )


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
