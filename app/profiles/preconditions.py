"""Whether a device may be configured now, and what keeps its motors where they are while it is.

A register by itself moves nothing as long as an axis has nowhere to go: its target is where it stands, or its velocity
mode wants no velocity. What is done to that end stays, and is told: it is motion, not configuration.
"""

from __future__ import annotations

from ..devices.core.device import Device
from ..devices.core.results import AxisState
from ..devices.tmc5xxx import rows as tmc5xxx
from ..devices.tmc5xxx.driver import Tmc5xxx
from ..devices.tmc428.chip import RampChip
from ..devices.tmc4361 import rows as tmc4361
from ..devices.tmc4361.driver import Tmc4361
from ..devices.tmcl.driver import Pd42
from ..errors import WrongState
from .steps import Step

STOP_IT = "stop it first"


async def require_rest(device: Device) -> dict[int, AxisState]:
    """The states of all axes. Raises WrongState where one moves or would, and for what configuration must not disturb;
    BenchError."""
    device.require_connected()
    states = {axis.index: await device.axis_state(axis.index) for axis in device.axes}
    for axis, state in states.items():
        if state.moving:
            raise WrongState(f"axis {axis} of {device.name} moves", STOP_IT)
        if state.target_velocity_pps and not state.mode.casefold().startswith(("ramp", "soft", "position")):
            raise WrongState(f"axis {axis} of {device.name} is held, but told to turn", STOP_IT)
    if isinstance(device, Tmc4361):
        regulation = (await device.read("ENC_IN_CONF", 0)).fields["regulation_modus"]
        if regulation:
            raise WrongState(f"the closed loop of {device.name} is on", "switch it off first")
    if isinstance(device, Pd42) and (await device.read("tmcl_application_status")).value:
        raise WrongState(f"a program runs on {device.name}, which may write parameters too", "stop it first")
    return states


async def hold_still(device: Device, states: dict[int, AxisState], steps: list[Step]) -> list[str]:
    """Take every reason to move from the axes that `steps` are about; what was done to that end. Raises BenchError."""
    told: list[str] = []
    touched = {step.register.axis for step in steps}
    for axis, state in states.items():
        if axis not in touched and None not in touched:
            continue
        if isinstance(device, RampChip):
            told += await _ramp_chip(device, axis, state)
        elif isinstance(device, Tmc5xxx):
            told += await _tmc5xxx(device, axis)
        elif isinstance(device, Tmc4361):
            told += await _tmc4361(device, state)
        elif state.target_position is not None and state.target_position != state.position:
            await device.stop(axis)
            told.append(f"axis {axis} was not at its target {state.target_position}: it was told to stop there")
    return told


async def _ramp_chip(device: RampChip, axis: int, state: AxisState) -> list[str]:
    if state.target_position == state.position:
        return []
    await device.write(device.rows[axis].x_target.name, axis, state.position)
    return [f"axis {axis}: the target is where it stands, {state.position} instead of {state.target_position}"]


async def _tmc5xxx(device: Tmc5xxx, axis: int) -> list[str]:
    rows = device.rows(axis)
    mode = (await device.read(rows.rampmode.name, axis)).value
    target = (await device.read(rows.xtarget.name, axis)).value
    position = (await device.read(rows.xactual.name, axis)).value
    told = []
    if target != position:
        await device.write(rows.xtarget.name, axis, position)
        told.append(f"axis {axis}: the target is where it stands, {position} instead of {target}")
    if mode != tmc5xxx.POSITION:
        # In velocity mode VMAX is the speed that it turns at, and writing it would set the motor off.
        await device.write(rows.rampmode.name, axis, tmc5xxx.POSITION)
        told.append(f"axis {axis} holds its position (RAMPMODE {tmc5xxx.POSITION} instead of {mode})")
    return told


async def _tmc4361(device: Tmc4361, state: AxisState) -> list[str]:
    mode = (await device.read(tmc4361.RAMPMODE.name, 0)).value
    if mode & tmc4361.POSITIONING_BIT and state.target_position == state.position:
        return []
    await device.stand_ready(0)
    return [f"axis 0 holds its position, {state.position} (RAMPMODE was {mode}, XTARGET {state.target_position})"]
