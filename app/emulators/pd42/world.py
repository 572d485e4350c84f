"""The bench around a module: what a patch does to it, and what there is to tell."""

from __future__ import annotations

from typing import Literal

from app.emulators.drive import Drive
from app.emulators.pd42.firmware import Firmware
from app.emulators.pd42.options import Forced, Pd42Options, Pd42Patch, StageChange
from app.emulators.pd42.parameters import SEARCH_MODE
from app.emulators.pd42.state import (
    ApplicationState,
    EncoderState,
    FaultsState,
    InputsState,
    MotorState,
    Pd42State,
    SearchState,
    StageState,
    SwitchesState,
    SwitchState,
    TruthState,
)
from app.links.errors import OutOfRange

_PLACES = ("left_at_fullsteps", "right_at_fullsteps", "home_from_fullsteps", "home_to_fullsteps")
_STATUS: tuple[Literal["stopped", "runs", "steps"], ...] = ("stopped", "runs", "steps")


def check_stage(drive: Drive, wanted: StageChange) -> None:
    """Raises OutOfRange where switches would change places."""
    places = {
        name: getattr(drive.world, name) if getattr(wanted, name) is None else getattr(wanted, name) for name in _PLACES
    }
    for low, high, touching in (
        ("left_at_fullsteps", "right_at_fullsteps", False),
        ("home_from_fullsteps", "home_to_fullsteps", True),
    ):
        if places[low] > places[high] or (places[low] == places[high] and not touching):
            raise OutOfRange(low, places[low], None, places[high], f"{high} lies to the right of it")


def change(drive: Drive, wanted: Pd42Patch) -> None:
    """Everything that is not the firmware's; the stage has been checked."""
    world = drive.world
    if wanted.motor.connected is not None:
        world.motor_connected = wanted.motor.connected
    if wanted.motor.temperature_c is not None:
        world.temperature_c = wanted.motor.temperature_c
    if wanted.load_torque_nm is not None:
        world.load_torque_nm = wanted.load_torque_nm
    if wanted.friction is not None:
        world.extra_friction_nm = wanted.friction
    if wanted.blocked is not None:
        world.blocked = wanted.blocked
    for name in _PLACES:
        place = getattr(wanted.stage, name)
        if place is not None:
            setattr(world, name, place)
    if wanted.stage.position_fullsteps is not None:
        world.rotor_fullsteps = wanted.stage.position_fullsteps
    if wanted.switches.left is not None:
        world.force_left = _forced(wanted.switches.left)
    if wanted.switches.right is not None:
        world.force_right = _forced(wanted.switches.right)
    if wanted.switches.home is not None:
        world.force_home = _forced(wanted.switches.home)
    encoder = wanted.encoder
    if encoder.slip_fullsteps is not None:
        world.encoder_slip_fullsteps += encoder.slip_fullsteps
    if encoder.external_slip_fullsteps is not None:
        world.external_slip_fullsteps += encoder.external_slip_fullsteps
    if encoder.eccentricity_deg is not None:
        world.eccentricity_deg = encoder.eccentricity_deg


def _forced(wanted: Forced) -> bool | None:
    return None if wanted == "auto" else wanted


def describe(
    drive: Drive,
    firmware: Firmware,
    options: Pd42Options,
    faults: FaultsState,
    *,
    time_scale: float,
    chip_time_s: float,
) -> Pd42State:
    """The module and its bench as the API tells them."""
    world, truth, switches = drive.world, drive.truth, drive.switches
    ports, application, axis = firmware.ports, firmware.application, firmware.axis
    levels = ports.levels()
    path = firmware.eeprom.path
    return Pd42State(
        time_scale=time_scale,
        chip_time_s=chip_time_s,
        address=firmware.globals.address,
        baud=firmware.globals.baud_in_force,
        motor=MotorState(
            connected=world.motor_connected,
            temperature_c=world.temperature_c,
            fullsteps_per_turn=4 * options.motor.rotor_teeth,
            torque_constant_nm_a=options.motor.torque_constant,
            holding_torque_nm=options.motor.holding_torque_nm,
            rated_current_a=options.motor.rated_current_a,
        ),
        load_torque_nm=world.load_torque_nm,
        blocked=world.blocked,
        friction=world.extra_friction_nm,
        supply_v=world.supply_v,
        stage=StageState(
            left_at_fullsteps=world.left_at_fullsteps,
            right_at_fullsteps=world.right_at_fullsteps,
            home_from_fullsteps=world.home_from_fullsteps,
            home_to_fullsteps=world.home_to_fullsteps,
            position_fullsteps=truth.rotor_fullsteps,
        ),
        switches=SwitchesState(
            left=SwitchState(active=switches.left, forced=world.force_left),
            right=SwitchState(active=switches.right, forced=world.force_right),
            home=SwitchState(active=switches.home, forced=world.force_home),
        ),
        encoder=EncoderState(
            absolute=drive.internal.absolute,
            counts=drive.internal.counts,
            external_counts=drive.external.counts,
            slip_fullsteps=world.encoder_slip_fullsteps,
            external_slip_fullsteps=world.external_slip_fullsteps,
            eccentricity_deg=world.eccentricity_deg,
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
        ),
        search=SearchState(mode=axis.parameters.values[SEARCH_MODE], phase=axis.phase_text),
        truth=TruthState(
            rotor_rad=truth.rotor_rad,
            rotor_fullsteps=truth.rotor_fullsteps,
            field_fullsteps=truth.field_fullsteps,
            speed_rad_s=truth.speed_rad_s,
            load_angle_deg=truth.load_angle_deg,
            current_a_a=truth.current_a_a,
            current_b_a=truth.current_b_a,
            torque_nm=truth.torque_nm,
            lost_fullsteps=truth.lost_fullsteps,
            current_scale=truth.current_scale,
            bridges=truth.bridges,
        ),
        eeprom_path=None if path is None else str(path),
    )
