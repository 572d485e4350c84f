"""Faults of a motor's driver, as studies heed them: none begins with one, and one that is seen meanwhile ends it.

Nothing is asked for it: each state of an axis has the flags of its driver in it.
"""

from __future__ import annotations

from ..clock import Clock
from ..devices.core.device import Device
from ..devices.core.results import AxisState

SEEN_AGAIN_S = 0.05
"""A fault is looked at a second time so much later [s]: drivers tell of an open coil now and then that is none, while
one that has switched off stays so."""


class DriverFault(Exception):
    """The driver has switched off, or finds its motor not connected: what the motor did tells nothing of a setting.

    Neither Failed nor a BenchError: no trial may take it for a result of its own.
    """


SEE = "see the condition of the axis"


def _causes(device: Device, axis: int, state: AxisState) -> list[str]:
    return [sign.cause for sign in device.monitor.signs(axis, state).faults]


def faults_told(device: Device, axis: int, state: AxisState) -> list[str]:
    """What is wrong with the axis now: nothing is studied meanwhile."""
    return [f"{cause}: {SEE}" for cause in _causes(device, axis, state)]


async def state_now(device: Device, axis: int, clock: Clock) -> AxisState:
    """The axis now, for a study that runs. Raises DriverFault where its driver reports a fault, BenchError."""
    state = await device.monitor.axis_state(axis)
    if _causes(device, axis, state):
        await clock.sleep(SEEN_AGAIN_S)
        state = await device.monitor.axis_state(axis)
        if causes := _causes(device, axis, state):
            raise DriverFault(f"ended by a fault of the driver: {'; '.join(causes)}; {SEE}")
    return state
