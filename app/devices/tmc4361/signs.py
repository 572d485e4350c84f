"""What a TMC4361 tells of its axis beside its state: zeros that keep it from moving, switches, stalls, the freeze."""

from __future__ import annotations

from ...errors import WrongState
from ..core.results import AxisState
from ..core.signs import Evidence, Sign, Signs, clear_flags, start_up, write, zero
from . import roles
from .cruise import Cruise
from .events import Events
from .memory import ChipMemory
from .switches import stopped_by

VELOCITY_PPS = 51_200
"""What a remedy writes to VMAX: a turn a second at 256 microsteps."""
DRIVER_FAULTS = {
    "OT": "the motor driver is too hot and has switched off",
    "S2GA": "the motor driver has switched off: a short in phase A",
    "S2GB": "the motor driver has switched off: a short in phase B",
}


def signs(memory: ChipMemory, cruise: Cruise, events: Events, axis: int, state: AxisState, *, stalled: bool) -> Signs:
    """Of `state`, as it was read just now."""
    return Signs(
        faults=tuple(
            Sign(cause, (Evidence(f"{roles.STATUS.name}.{name}", "1", state.time_s),))
            for name, cause in DRIVER_FAULTS.items()
            if state.flags.get(name)
        ),
        blocks=tuple(_blocks(memory, cruise, axis, state)),
        stall=_stall(memory, axis, state, stalled=stalled),
        holds=tuple(_holds(memory, state)),
        takes_encoder=True,
        resets=events.resets,
        regulated=roles.REGULATION.unpack(memory.known(roles.ENC_IN_CONF) or 0) != 0,
    )


def _blocks(memory: ChipMemory, cruise: Cruise, axis: int, state: AxisState) -> list[Sign]:
    found = []
    if state.flags.get("FROZEN"):
        cause = "NFREEZE went low: the chip is frozen until a reset"
        found.append(Sign(cause, (Evidence(f"{roles.EVENTS.name}.FROZEN", "1", state.time_s),)))
    ramp = memory.ramp()
    if ramp is None or state.moving:
        return found
    if cruise.speed == 0:
        found.append(zero(roles.VMAX.name, axis, VELOCITY_PPS * 256 if ramp.positioning else None, state.time_s))
    try:
        ramp.require_motion(cruise.shape)
    except WrongState as error:
        found.append(Sign(str(error), (), (start_up(axis),)))
    return found


def _stall(memory: ChipMemory, axis: int, state: AxisState, *, stalled: bool) -> Sign | None:
    evidence, helps = [], []
    for register, name in ((roles.STATUS, "ACTIVE_STALL_F"), (roles.EVENTS, "STOP_ON_STALL")):
        if state.flags.get(name):
            evidence.append(Evidence(f"{register.name}.{name}", "1", state.time_s))
            helps = [clear_flags(axis, moves=True)]
    if not evidence and not stalled:
        return None
    name = "drv_after_stall"
    if stalled and not roles.REFERENCE_CONF.unpack(memory.known(roles.REFERENCE_CONF) or 0)[name]:
        evidence.append(Evidence(f"{roles.REFERENCE_CONF.name}.{name}", "0", state.time_s))
        helps.append(write(roles.REFERENCE_CONF.name, axis, 1, name))
    return Sign("the motor driver reported a stall", tuple(evidence), tuple(helps))


def _holds(memory: ChipMemory, state: AxisState) -> list[Sign]:
    flags = {name: int(value) for name, value in state.flags.items()}
    reference = roles.REFERENCE_CONF.unpack(memory.known(roles.REFERENCE_CONF) or 0)
    found = []
    for way, free in ((-1, "to greater positions"), (1, "to smaller positions")):
        stop = stopped_by(flags, reference, way)
        if stop:
            found.append(
                Sign(f"the {stop} is active: only the way {free} is free", (Evidence(stop, "active", state.time_s),))
            )
    return found
