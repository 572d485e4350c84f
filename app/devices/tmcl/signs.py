"""What a TMCL module tells of its axis beside its state: errors of its driver, parameters that are 0, switches."""

from __future__ import annotations

from ..core.results import AxisState
from ..core.signs import Evidence, Sign, Signs, hot, start_up, write, zero
from .state import ModuleState

FAULTS = {
    "overtemperature": "the driver is too hot and has switched off",
    "short_to_ground_a": "coil A is shorted to ground, and the driver is off",
    "short_to_ground_b": "coil B is shorted to ground, and the driver is off",
}
VELOCITY_PPS, ACCELERATION_PPS2 = 51_200.0, 51_200.0
"""What a remedy writes where a limit of the ramp is 0: a turn a second, in 1 s, at 256 microsteps."""
OFF_TIME, MAX_CURRENT = 5, 128
"""As it comes from the factory."""


def signs(module: ModuleState, axis: int, state: AxisState) -> Signs:
    """Of `state`, as it was read just now."""
    return Signs(
        faults=tuple(
            Sign(
                cause,
                (Evidence(f"{module.roles.driver_flags.name}.{name}", "1", state.time_s),),
                (write(module.roles.off_time.name, axis, 0),) if name.startswith("short") else (),
            )
            for name, cause in FAULTS.items()
            if state.flags.get(name)
        ),
        warnings=hot(
            state.flags,
            "overtemperature_warning",
            "overtemperature",
            Evidence(f"{module.roles.driver_flags.name}.overtemperature_warning", "1", state.time_s),
        ),
        blocks=tuple(_blocks(module, axis, state)),
        stall=_stopped("stall_stop", "StallGuard stopped the motor", state),
        holds=tuple(_holds(module, state)),
        takes_encoder=2 * abs(state.deviation or 0) > abs(state.external_deviation or 0),
    )


def _blocks(module: ModuleState, axis: int, state: AxisState) -> list[Sign]:
    found = []
    for row, factory, cause in (
        (module.roles.off_time, OFF_TIME, "the driver is off"),
        (module.roles.max_current, MAX_CURRENT, "the motor gets no current"),
    ):
        if module.last(row) == 0:
            evidence = (Evidence(row.name, "0", state.time_s),)
            found.append(Sign(f"{cause} ({row.name} is 0)", evidence, (start_up(axis), write(row.name, axis, factory))))
    if state.moving:
        return found
    for row, value in (
        (module.roles.max_speed, VELOCITY_PPS / module.speed_unit_pps),
        (module.roles.max_acceleration, ACCELERATION_PPS2 / module.acceleration_unit_pps2),
    ):
        if module.last(row) == 0:
            found.append(zero(row.name, axis, round(value), state.time_s))
    return found


def _stopped(flag: str, cause: str, state: AxisState) -> Sign | None:
    if not state.flags.get(flag):
        return None
    return Sign(cause, (Evidence(f"extended_error_flags.{flag}", "1", state.time_s),))


def _holds(module: ModuleState, state: AxisState) -> list[Sign]:
    found = []
    for side, active, off, free in (
        ("left", state.switches.left, module.roles.left_disabled, "to greater positions"),
        ("right", state.switches.right, module.roles.right_disabled, "to smaller positions"),
    ):
        if active and module.last(off) == 0:
            found.append(
                Sign(
                    f"the {side} switch is active: only the way {free} is free",
                    (Evidence(f"{side} switch", "active", state.time_s),),
                )
            )
    return found
