"""A way of one axis that ends where a switch is pressed, or released."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..clock import Clock
from ..devices.core.device import Device
from ..devices.core.results import AxisState
from ..procedures.procedure import POLL_S, Failed
from .driver_faults import state_now
from .moves import LONGEST

Side = Literal["left", "right"]
STANDS_S = 0.5
"""A motor may stand so long on a way [s]: as it sets off, or reverses."""
UNTOLD_S, STARTS_S = 60.0, 2.0
"""What a way is taken for where nothing predicts it, and what it may take beside [s]."""


@dataclass(frozen=True, slots=True)
class SwitchMet:
    """Where a switch was seen to change: between two looks at the counter [microsteps].

    seen : False where the motor was found to stand short of its target, and the switch released: it had stopped the
        motor, whose rotor has swung out of it since
    """

    before: int
    at: int
    seen: bool


def is_pressed(state: AxisState, side: Side) -> bool:
    """Whether that switch is."""
    return bool(state.switches.left if side == "left" else state.switches.right)


async def go_until_switch(
    device: Device, axis: int, clock: Clock, side: Side, target: int, *, pressed: bool, longest_s: float | None = None
) -> SwitchMet | None:
    """Go to `target` until the switch is `pressed`, or is not, and come to rest; None where it was not on the way.

    longest_s : the device's time that it may take; None: what the device predicts, three times over
    Raises Failed where neither comes within that time, BenchError.
    """
    state = await state_now(device, axis, clock)
    at, since_s = state.position, device.device_time_s()
    met = SwitchMet(at, at, seen=True) if is_pressed(state, side) == pressed else None
    if met is None and state.position != target:
        started = await device.motion.move(axis, target)
        longest_s = longest_s or LONGEST * (started.predicted_duration_s or UNTOLD_S) + STARTS_S
    until_s = since_s + (longest_s or STARTS_S)
    while state.moving or (met is None and state.position != target):
        await clock.sleep(POLL_S)
        before, state = state.position, await state_now(device, axis, clock)
        if state.position != at:
            at, since_s = state.position, device.device_time_s()
        seen = is_pressed(state, side) == pressed
        # One that stands short of a switch was stopped by it, and has swung out of it since.
        stopped = pressed and at != target and device.device_time_s() - since_s > STANDS_S
        if met is None and (seen or stopped):
            met = SwitchMet(before, at, seen)
            if at != target:
                await device.stop(axis)  # also where the switch has stopped it: released, it would go on
        if device.device_time_s() > until_s:
            raise Failed(f"neither {target} nor the edge of the {side} switch came within its time")
    return met
