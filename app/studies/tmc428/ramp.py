"""The registers of a TMC428, TMC429 or TMC4210 that make its ramp, and the pair by which it brakes (DS-TMC428 8.10)."""

from __future__ import annotations

from collections.abc import Mapping

from ...calc.ramps.pmul_pdiv import a_max_lower_limit, a_max_upper_limit, default_reduction, design_many
from ...profiles.physical import UnitContext
from ...registers.catalog import MODELS
from ..field_settings import Place
from ..ramp_settings import ACCELERATION, SPEED, RampRegisters

PMUL, PDIV = Place("pmul_pdiv", "pmul"), Place("pmul_pdiv", "pdiv")


class Proportionality:
    """pmul and pdiv for an acceleration, reduced as the data sheet of the chip advises."""

    places = (PMUL, PDIV)

    def allowed(self, units: UnitContext, axis: int) -> tuple[int, int]:
        """Within what a_max brakes, and has a pair (DS-TMC428 8.7.1)."""
        dividers = _dividers(units, axis)
        return a_max_lower_limit(*dividers), a_max_upper_limit(*dividers)

    def of(self, units: UnitContext, axis: int, acceleration: int) -> Mapping[Place, int]:
        """The pair of an a_max."""
        found = design_many(acceleration, *_dividers(units, axis), default_reduction(units.model))
        field = MODELS[units.model].table.get(PMUL.register, axis).field_named(PMUL.field)
        assert field is not None
        # A TMC4210 counts PMUL with its leading one, the others without.
        return {PMUL: int(found.p_mul) & (1 << field.width) - 1, PDIV: int(found.pdiv)}


def _dividers(units: UnitContext, axis: int) -> tuple[int, int]:
    """ramp_div and pulse_div."""
    ramp_div, pulse_div = (units.field(name, axis) or 0 for name in ("ramp_div", "pulse_div"))
    return ramp_div, pulse_div


RAMP = RampRegisters({SPEED: ("v_max",), ACCELERATION: ("a_max",)}, fitting=Proportionality())
