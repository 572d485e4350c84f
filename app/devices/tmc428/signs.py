"""What a chip with three or one of the TMC428's ramp generators tells of an axis beside its state."""

from __future__ import annotations

from ..core.results import AxisState
from ..core.signs import Evidence, Sign, Signs, zero
from .axis_roles import AxisRoles
from .ramp_parameters import RampParameters

V_MAX, A_MAX = 1000, 500
"""What a remedy writes where one of them is 0: half of the greatest speed, and a ramp of some tenths of a second."""


def signs(rows: AxisRoles, axis: int, ramp: RampParameters | None, state: AxisState) -> Signs:
    """Of `state`, as it was read just now."""
    if ramp is None:
        return Signs()
    blocks = []
    if not state.moving:
        for row, held, value in ((rows.v_max, ramp.v_max, V_MAX), (rows.a_max, ramp.a_max, A_MAX)):
            if held == 0:
                blocks.append(zero(row.name, axis, value, state.time_s))
    holds = []
    for way, free in ((-1, "to greater positions"), (1, "to smaller positions")):
        switch = ramp.blocked(rows, way, state.switches.left, state.switches.right)
        if switch:
            cause = f"the {switch} switch is active: only the way {free} is free"
            holds.append(Sign(cause, (Evidence(f"{switch} switch", "active", state.time_s),)))
    return Signs(blocks=tuple(blocks), holds=tuple(holds))
