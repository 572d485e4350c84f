"""What a TMC4361 tells of its axis beside its state: zeros that keep it from moving, switches, stalls, the freeze."""

from __future__ import annotations

from ...errors import WrongState
from ..core.results import AxisState
from ..core.signs import Evidence, Sign, Signs, clear_flags, hot, start_up, write, zero
from . import roles
from .cruise import Cruise
from .events import Events
from .memory import ChipMemory
from .switches import stopped_by

VELOCITY_PPS = 51_200
"""What a remedy writes to VMAX: a turn a second at 256 microsteps."""
UNNAMED = "the motor driver"
TMC24X = roles.TMC24X_FORMS[-1]
"""spi_output_format of the one that measures a load."""
DRIVER_FAULTS = {
    "OT": "is too hot and has switched off",
    "S2GA": "has switched off: a short in phase A",
    "S2GB": "has switched off: a short in phase B",
    "OCA": "sees too much current in coil A: is it shorted?",
    "OCB": "sees too much current in coil B: is it shorted?",
    "OCHS": "sees too much current on its high side: is a coil shorted to ground?",
    "UV_SF": "has too little supply voltage",
}
"""What a flag of STATUS says of a driver that is off, the worst first."""
OPEN, STALL, UNDERVOLTAGE = ("OLA", "OLB"), "SG", "UV_SF"
SLOW_FULLSTEPS_PER_S = 400.0
"""Faster than that flags of open loads tell nothing (DS-TMC2660 6.10, "slow motion"; the figure INFERRED)."""


def signs(
    memory: ChipMemory,
    cruise: Cruise,
    events: Events,
    axis: int,
    state: AxisState,
    *,
    stalled: bool,
    driver: str | None = None,
) -> Signs:
    """Of `state`, as it was read just now. `driver` is the name of the device that drives the axis, if one does."""
    return Signs(
        faults=_driver_faults(memory, driver or UNNAMED, state),
        warnings=hot(state.flags, "OTPW", "OT", _told("OTPW", state), driver or UNNAMED),
        blocks=tuple(_blocks(memory, cruise, axis, state)),
        stall=_stall(memory, axis, state, driver or UNNAMED, stalled=stalled),
        stalling=_stalling(memory, driver, state),
        holds=tuple(_holds(memory, state)),
        takes_encoder=True,
        resets=events.resets,
        regulated=roles.REGULATION.unpack(memory.known(roles.ENC_IN_CONF) or 0) != 0,
    )


def _driver_faults(memory: ChipMemory, who: str, state: AxisState) -> tuple[Sign, ...]:
    """What the driver has switched off for, and coils that are not connected."""
    found = [
        Sign(f"{who} {cause}", (_told(name, state),))
        for name, cause in DRIVER_FAULTS.items()
        if state.flags.get(name) and not (name == UNDERVOLTAGE and _tells_stalls(memory))
    ]
    coils = [name for name in OPEN if state.flags.get(name)]
    slow = abs(state.velocity_pps) / memory.microsteps <= SLOW_FULLSTEPS_PER_S
    if coils and state.moving and slow:
        where = "coils A and B" if len(coils) > 1 else f"coil {coils[0][-1]}"
        evidence = tuple(_told(name, state) for name in coils)
        found.append(Sign(f"{who} finds no load at {where}: is the motor connected?", evidence))
    return tuple(found)


def _tells_stalls(memory: ChipMemory) -> bool:
    """Whether bit 24 of a TMC24x is set up to be a stall, not undervoltage."""
    conf = memory.known(roles.SPI_OUT_CONF) or 0
    return roles.OUTPUT_FORMAT.unpack(conf) == TMC24X and bool(roles.STALL_FOR_UNDERVOLTAGE.unpack(conf))


def _stalling(memory: ChipMemory, driver: str | None, state: AxisState) -> Sign | None:
    """That the motor does not follow, while it is stepped. What bit 24 of one without a name is nobody knows, unless
    the chip works it out itself."""
    if _tells_stalls(memory):
        name, who = UNDERVOLTAGE, driver or UNNAMED
    elif driver is not None:
        name, who = STALL, driver
    else:
        return None
    if not state.moving or not state.flags.get(name):
        return None
    return Sign(f"{who} tells of a stall: the motor does not follow", (_told(name, state),))


def _told(name: str, state: AxisState) -> Evidence:
    return Evidence(f"{roles.STATUS.name}.{name}", "1", state.time_s)


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


def _stall(memory: ChipMemory, axis: int, state: AxisState, who: str, *, stalled: bool) -> Sign | None:
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
    return Sign(f"{who} reported a stall", tuple(evidence), tuple(helps))


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
