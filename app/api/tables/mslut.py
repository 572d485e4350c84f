"""Between the shapes of MSLUT tables and the calculators and drivers behind them. The rules are in app/calc/mslut*."""

from __future__ import annotations

from collections.abc import Sequence

from ...calc.microsteps import mslut
from ...calc.microsteps.mslut import MslutRegisters, NotEncodable, Wave
from ...calc.microsteps.mslut_metrics import mslut_metrics
from ...calc.microsteps.mslut_nearest import Norm, nearest
from ...calc.microsteps.mslut_waves import Formula, Grid, RequestedWave, Term, exponent_of_thousandths, wanted_wave
from ...devices.core.results import HeldMslut
from ...errors import UsageError
from ...registers.catalog import MODELS
from ...registers.model import Register, RegisterTable
from ..devices.views import calculating
from ..http.errors import UnencodableWave
from .mslut_schemas import (
    MslutDesign,
    MslutFigures,
    MslutHeld,
    MslutNearest,
    MslutRefusal,
    MslutRegister,
    MslutResult,
    MslutSegment,
    MslutTable,
    MslutWords,
    MslutWrite,
)

REFUSALS_TOLD = 40
"""A wave that is far from encodable is refused at most of its entries; the first ones are enough to see where."""


def has_mslut(table: RegisterTable) -> bool:
    return table.find("MSLUTSEL", 0) is not None


def design(body: MslutDesign) -> MslutResult:
    table = MODELS[body.chip].table
    with calculating():
        wanted = _wanted(body)
        metrics = mslut_metrics(wanted.wave, wanted.ideal)
        formula = () if wanted.refusal is None else (wanted.refusal,)
        refusals = (*formula, *mslut.refusals(wanted.wave))
        return MslutResult(
            chip=body.chip,
            encodable=not refusals,
            values=list(wanted.wave.values),
            mirror=wanted.wave.mirror,
            ideal=None if wanted.ideal is None else wanted.ideal.tolist(),
            table=None if refusals else _table(_encoded(body, wanted.wave), table),
            refusals=[MslutRefusal.model_validate(refusal) for refusal in refusals[:REFUSALS_TOLD]],
            nearest=_nearest(wanted, body.norm, table) if refusals else None,
            metrics=MslutFigures.model_validate(metrics),
            warnings=[*wanted.warnings, *metrics.warnings],
        )


def registers_to_write(body: MslutWrite) -> MslutRegisters:
    """Raises UsageError unless there is one of values and registers, and UnencodableWave."""
    if (body.values is None) == (body.registers is None):
        raise UsageError("a table is given by its values or by its registers: one of the two")
    if body.registers is not None:
        return _registers(body.registers)
    values: Sequence[int] = body.values or ()
    with calculating():
        try:
            return mslut.encode(values, body.mirror)
        except NotEncodable as error:
            closest = nearest(values, body.mirror)
            raise UnencodableWave(error.refusal, closest.distance_max) from error


def held(state: HeldMslut, table: RegisterTable, axis: int = 0) -> MslutHeld:
    wave = mslut.decode(state.registers)
    expected_a, expected_b = wave.currents(state.position)
    return MslutHeld(
        **_table(state.registers, table, axis).model_dump(),
        written=state.written,
        position=state.position,
        current_a=state.current_a,
        current_b=state.current_b,
        current_a_expected=expected_a,
        current_b_expected=expected_b,
        agrees=(expected_a, expected_b) == (state.current_a, state.current_b),
    )


def _wanted(body: MslutDesign) -> RequestedWave:
    if body.values is not None and body.registers is not None:
        raise ValueError("a wave is drawn (values) or held by a chip (registers), not both")
    if body.registers is not None:
        return RequestedWave(None, mslut.decode(_registers(body.registers)), None, ())
    if body.values is not None:
        return RequestedWave(None, mslut.checked(body.values, body.mirror), None, ())
    exponent = body.exponent
    if body.thousandths is not None:
        if exponent != 1.0:
            raise ValueError("the exponent is given by itself or in thousandths, not both")
        exponent = exponent_of_thousandths(body.thousandths)
    usual: Grid = "complement" if exponent == 1.0 else "whole_step"
    return wanted_wave(
        Formula(
            sigma=body.sigma,
            exponent=exponent,
            harmonics=tuple(Term(term.order, term.amplitude, term.phase_deg) for term in body.harmonics),
            corrections=tuple(Term(term.order, term.degrees, term.phase_deg) for term in body.corrections),
            amplitude=body.amplitude,
            full_scale=body.full_scale,
            grid=body.grid or usual,
        )
    )


def _encoded(body: MslutDesign, wave: Wave) -> MslutRegisters:
    # registers of a chip stay as they are: another segmentation of the same wave would look like a difference
    return mslut.encode(wave.values, wave.mirror) if body.registers is None else _registers(body.registers)


def _nearest(wanted: RequestedWave, norm: Norm, table: RegisterTable) -> MslutNearest:
    target = wanted.wave.values if wanted.ideal is None else wanted.ideal
    found = nearest(target, wanted.wave.mirror, norm)
    return MslutNearest(
        norm=norm,
        table=_table(mslut.encode(found.wave.values, found.wave.mirror), table),
        distance_rms=found.distance_rms,
        distance_max=found.distance_max,
        metrics=MslutFigures.model_validate(mslut_metrics(found.wave, wanted.ideal)),
    )


def _registers(words: MslutWords) -> MslutRegisters:
    return MslutRegisters(tuple(words.mslut), words.mslutsel, words.mslutstart)


def _table(registers: MslutRegisters, table: RegisterTable, axis: int = 0) -> MslutTable:
    wave = mslut.decode(registers)
    rows = [*zip(_rows(table, axis), (*registers.words, registers.select, registers.start), strict=True)]
    return MslutTable(
        values=list(wave.values),
        mirror=wave.mirror,
        registers=[
            MslutRegister(name=row.name, address=row.address, value=value, hex=f"{value:08X}") for row, value in rows
        ],
        segments=[MslutSegment.model_validate(segment) for segment in mslut.segments_of(registers.select)],
    )


def _rows(table: RegisterTable, axis: int) -> list[Register]:
    """MSLUT[0..7], MSLUTSEL and the register of START_SIN: names are the same in the family, addresses are not."""
    names = (*(f"MSLUT[{index}]" for index in range(8)), "MSLUTSEL", "START_SIN")
    found = [table.find(name, axis) for name in names]
    return [entry[0] for entry in found if entry is not None]
