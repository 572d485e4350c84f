"""Applies patches to an emulated module and its plant, and describes both as its emulator state."""

from __future__ import annotations

from typing import Literal

from ..core.base import Times
from ..drive import Drive
from ..drive.documents import (
    change_stage,
    check_stage,
    motor_state,
    places_of,
    stage_state,
    truth_state,
)
from ..motor_documents import change_load, force_switches, require_physics
from .firmware import Firmware
from .options import TmclPatch
from .parameters import SEARCH_MODE
from .state import (
    ApplicationState,
    EncoderState,
    FaultsState,
    InputsState,
    SearchState,
    SwitchesState,
    SwitchState,
    TmclState,
)

_STATUS: tuple[Literal["stopped", "runs", "steps"], ...] = ("stopped", "runs", "steps")


def check(drive: Drive, wanted: TmclPatch) -> None:
    """Raises OutOfRange or WrongState for what cannot be done to this bench."""
    require_physics(drive.options.rigid, wanted)
    check_stage(places_of(drive.plant), wanted.stage)


def change(drive: Drive, wanted: TmclPatch) -> None:
    """Everything that is not the firmware's; the stage has been checked."""
    plant = drive.plant
    change_load(plant, wanted)
    change_stage(plant, wanted.stage)
    force_switches(plant, wanted.switches)
    encoder = wanted.encoder
    if encoder.slip_fullsteps is not None:
        plant.encoder_slip_fullsteps += encoder.slip_fullsteps
    if encoder.external_slip_fullsteps is not None:
        plant.external_slip_fullsteps += encoder.external_slip_fullsteps
    if encoder.eccentricity_deg is not None:
        plant.eccentricity_deg = encoder.eccentricity_deg


def describe(
    model: str,
    drive: Drive,
    firmware: Firmware,
    faults: FaultsState,
    times: Times,
) -> TmclState:
    """The module and its bench as the API tells them."""
    plant, state, switches = drive.plant, drive.plant_state, drive.switches
    ports, application, axis = firmware.ports, firmware.application, firmware.axis
    levels = ports.levels()
    path = firmware.eeprom.path
    return TmclState(
        model=model,
        **times,
        address=firmware.globals.address,
        baud=firmware.globals.baud_in_force,
        motor=motor_state(plant, drive.options.motor),
        rigid=drive.options.rigid,
        load_torque_nm=plant.load_torque_nm,
        blocked=plant.blocked,
        friction=plant.extra_friction_nm,
        supply_v=plant.supply_v,
        stage=stage_state(plant, state),
        switches=SwitchesState(
            left=SwitchState(active=switches.left, forced=plant.force_left),
            right=SwitchState(active=switches.right, forced=plant.force_right),
            home=SwitchState(active=switches.home, forced=plant.force_home),
        ),
        encoder=EncoderState(
            absolute=drive.internal.absolute,
            counts=drive.internal.counts,
            external_counts=drive.external.counts,
            slip_fullsteps=plant.encoder_slip_fullsteps,
            external_slip_fullsteps=plant.external_slip_fullsteps,
            eccentricity_deg=plant.eccentricity_deg,
        ),
        inputs=InputsState(
            in0=levels[0], in1=levels[1], in2=levels[2], in3=levels[3], analog=ports.analog, outputs=ports.outputs
        ),
        faults=faults,
        application=ApplicationState(
            status=_STATUS[application.status],
            counter=application.counter,
            downloading=application.downloading,
            commands=len(firmware.eeprom.program),
            accumulator=application.accumulator,
            x=application.x,
            flags=application.flags,
            stack=application.stack,
            waits=firmware.interpreter.waits,
            interrupted=firmware.interpreter.serves,
            error=application.last_error,
        ),
        search=SearchState(mode=axis.parameters.values[SEARCH_MODE], phase=axis.phase_text),
        truth=truth_state(state),
        eeprom_path=None if path is None else str(path),
    )
