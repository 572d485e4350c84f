"""What a driver tells of its motor beside the state: faults, and what keeps it from moving."""

from __future__ import annotations

from ..core.results import AxisState
from ..core.signs import Evidence, Sign, Signs, clear_flags, hot, start_up, write
from .memory import DriverMemory
from .roles import part

GSTAT_FAULTS = {
    "uv_cp": "the charge pump has too little voltage, and the driver is off",
    "drv_err": "the driver has shut down",
}
DRIVER_FAULTS = {
    "ot": "the driver is too hot and has switched off",
    "s2ga": "phase A is shorted to ground, and the driver is off",
    "s2gb": "phase B is shorted to ground, and the driver is off",
    "s2vsa": "phase A is shorted to the supply, and the driver is off",
    "s2vsb": "phase B is shorted to the supply, and the driver is off",
}
SHORTS = frozenset({"s2ga", "s2gb", "s2vsa", "s2vsb"})
OFF_TIME = 3


def signs(memory: DriverMemory, resets: int, state: AxisState) -> Signs:
    """Of `state`, as it was read just now."""
    return Signs(
        faults=tuple(_faults(memory, state)),
        warnings=hot(state.flags, "otpw", "ot", Evidence(f"{memory.rows.drv_status.name}.otpw", "1", state.time_s)),
        blocks=tuple(_blocks(memory, state)),
        resets=resets,
    )


def _faults(memory: DriverMemory, state: AxisState) -> list[Sign]:
    rows, found = memory.rows, []
    # The cause first: GSTAT says only that there is one.
    for register, told in ((rows.drv_status, DRIVER_FAULTS), (rows.gstat, GSTAT_FAULTS)):
        for name, cause in told.items():
            if state.flags.get(name):
                # A short is kept until the driver is switched off; then what is beside it says how to switch it on.
                off = (write(rows.chopconf.name, 0, 0, "toff"),) if name in SHORTS else ()
                evidence = (Evidence(f"{register.name}.{name}", "1", state.time_s),)
                found.append(Sign(cause, evidence, (*off, clear_flags(0))))
    return found


def _blocks(memory: DriverMemory, state: AxisState) -> list[Sign]:
    rows, found = memory.rows, []
    chopper = memory.word(rows.chopconf)
    if chopper is not None and part(rows.chopconf, "toff").unpack(chopper) == 0:
        name = f"{rows.chopconf.name}.toff"
        found.append(
            Sign(
                f"the driver is off ({name} is 0)",
                (Evidence(name, "0", state.time_s),),
                (start_up(0), write(rows.chopconf.name, 0, OFF_TIME, "toff")),
            )
        )
    if state.flags.get(rows.disable_pin):
        evidence = (Evidence(f"{rows.inputs.name}.{rows.disable_pin}", "1", state.time_s),)
        found.append(Sign("the pin ENN is high and switches the driver off (only its wire can change that)", evidence))
    return found
