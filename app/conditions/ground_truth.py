"""Ground truth of an emulated axis for its condition: from the emulator itself, past driver and link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

from ..devices.core.device import Device
from ..emulators.core.family import Emulator
from ..links.emulator import EmulatorPort


@dataclass(frozen=True, slots=True)
class AxisGroundTruth:
    """One axis in the microsteps that its chip counts; None where the emulator has no such thing."""

    summary: str
    lost_steps: float | None
    shaft_position: float | None
    blocked: bool | None
    speed_pps: float | None
    bridges: str


def ground_truth_of(device: Device, axis: int) -> AxisGroundTruth | None:
    """Ground truth of the axis; None where it is no emulator in this process."""
    port = device.session.port
    if not isinstance(port, EmulatorPort):
        return None
    told = cast("Emulator", port.wire).ground_truth(axis, port.take_turn())
    microsteps = device.axis(axis).microsteps_per_full_step or 256
    lost = None if told.lost_fullsteps is None else float(told.lost_fullsteps * microsteps)
    shaft = told.shaft_fullsteps * microsteps
    speed = None if told.speed_fullsteps_s is None else told.speed_fullsteps_s * microsteps
    said = [f"the shaft is at {shaft:,.0f} microsteps from where it was built"]
    if lost is not None:
        said.append(f"{abs(lost):,.0f} microsteps {'won' if lost < 0 else 'lost'}" if lost else "no step lost")
    if told.blocked:
        said.append("blocked")
    if told.bridges in ("open", "shorted"):
        said.append(f"bridges {told.bridges}")
    return AxisGroundTruth("; ".join(said), lost, shaft, told.blocked, speed, told.bridges)
