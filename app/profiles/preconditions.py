"""Whether a device may be configured now, and what keeps its motors where they are while it is.

A register by itself moves nothing as long as an axis has nowhere to go: its target is where it stands, or its velocity
mode wants no velocity. What is done to that end stays, and is told: it is motion, not configuration.
"""

from __future__ import annotations

from ..devices.core.device import Device
from ..devices.core.results import AxisState
from ..errors import WrongState
from .steps import Step

STOP_IT = "stop it first"


async def require_rest(device: Device) -> dict[int, AxisState]:
    """The states of all axes. Raises WrongState where one moves or would, and for what configuration must not disturb;
    BenchError."""
    device.session.require_connected()
    states = {axis.index: await device.monitor.axis_state(axis.index) for axis in device.axes}
    for axis, state in states.items():
        if state.moving:
            raise WrongState(f"axis {axis} of {device.name} moves", STOP_IT)
        if state.target_velocity_pps and not state.mode.casefold().startswith(("ramp", "soft", "position")):
            raise WrongState(f"axis {axis} of {device.name} is held, but told to turn", STOP_IT)
    await device.configuration.require_idle()
    return states


async def hold_still(device: Device, states: dict[int, AxisState], steps: list[Step]) -> list[str]:
    """Take every reason to move from the axes that `steps` are about; what was done to that end. Raises BenchError."""
    told: list[str] = []
    touched = {step.register.axis for step in steps}
    for axis, state in states.items():
        if axis not in touched and None not in touched:
            continue
        told += await device.configuration.hold_still(axis, state)
    return told
