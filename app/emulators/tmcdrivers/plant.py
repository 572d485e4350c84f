"""Applies patches to an emulated driver and its plant, and describes both as its emulator state."""

from __future__ import annotations

from dataclasses import asdict
from typing import Protocol

from ..core.base import ChipFaults, Times
from ..drive import Drive
from ..drive.documents import ChipFaultsState, motor_state, truth_state
from ..motor_documents import change_load
from .options import DriverModel, TmcDriverOptions, TmcDriverPatch
from .state import DriverPinsState, DriverUartState, TmcDriverState


class DriverChip(Protocol):
    """A driver with its motor, and what is at its pins."""

    drive: Drive
    enn: bool
    """Level at ENN: high switches the bridges off."""
    step_hz: float
    """Steps that come in at a steady frequency [Hz, signed]."""
    steps_made: int
    """Steps that came one by one and were made, signed, since power-on."""

    @property
    def diag(self) -> bool:
        """Whether the pin that tells of errors or stalls is active."""
        ...


def change(chip: DriverChip, wanted: TmcDriverPatch) -> None:
    """Pins, supply, motor and load; `wanted` has been checked, and its power cycle is over."""
    plant = chip.drive.plant
    if wanted.pins.enn is not None:
        chip.enn = wanted.pins.enn
    if wanted.pins.step_hz is not None:
        chip.step_hz = wanted.pins.step_hz
    if wanted.supply_v is not None:
        plant.supply_v = wanted.supply_v
    change_load(plant, wanted)


def describe(
    model: DriverModel,
    chip: DriverChip,
    options: TmcDriverOptions,
    times: Times,
    faults: ChipFaults,
    uart: DriverUartState | None = None,
    *,
    index: bool | None = None,
    vref_v: float | None = None,
) -> TmcDriverState:
    """The driver and its bench as the API tells them."""
    drive = chip.drive
    plant = drive.plant
    return TmcDriverState(
        model=model,
        **times,
        clock_hz=options.clock_hz,
        rigid=options.rigid,
        supply_v=plant.supply_v,
        motor=motor_state(plant, drive.options.motor),
        load_torque_nm=plant.load_torque_nm,
        blocked=plant.blocked,
        friction=plant.extra_friction_nm,
        truth=truth_state(drive.plant_state),
        uart=uart,
        pins=DriverPinsState(
            enn=chip.enn,
            diag=chip.diag,
            index=index,
            vref_v=vref_v,
            step_hz=chip.step_hz,
            steps=chip.steps_made,
        ),
        faults=ChipFaultsState(**asdict(faults)),
    )
