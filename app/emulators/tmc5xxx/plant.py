"""Applies patches to an emulated chip and its plant, and describes both as its emulator state."""

from __future__ import annotations

from ...errors import OutOfRange
from ..core.base import Times
from ..core.uart_end import UartEnd
from ..drive import Drive
from ..drive.documents import (
    ChipFaultsState,
    change_stage,
    check_stage,
    motor_state,
    places_of,
    stage_state,
    truth_state,
)
from ..motor_documents import change_load, force_switches, require_physics
from .options import AxisChange, Tmc5xxxModel, Tmc5xxxOptions, Tmc5xxxPatch
from .registers import Chip
from .state import (
    AxisState,
    EncoderState,
    PinsState,
    PositionCompareState,
    SwitchesState,
    SwitchState,
    Tmc5xxxState,
    UartState,
)


def check(chip: Chip, model: Tmc5xxxModel, options: Tmc5xxxOptions, wanted: Tmc5xxxPatch) -> None:
    """Raises OutOfRange or WrongState for what cannot be done to this chip."""
    for axis in wanted.axes:
        if axis.axis >= chip.kind.axes:
            raise OutOfRange("axis", axis.axis, 0, chip.kind.axes - 1, f"a {model.upper()} has {chip.kind.axes}")
        if axis.encoder.slip_fullsteps is not None and not chip.has_encoder:
            raise OutOfRange("encoder", axis.axis, 0, 0, f"a {model.upper()} has no encoder interface")
        require_physics(options.rigid, axis)
        check_stage(places_of(chip.axes[axis.axis].drive.plant), axis.stage)


def change(chip: Chip, wanted: Tmc5xxxPatch) -> None:
    """Everything; it has been checked."""
    if wanted.pins.drv_enn is not None:
        chip.drv_enn = wanted.pins.drv_enn
    if wanted.pins.nextaddr is not None:
        chip.node_pin = wanted.pins.nextaddr
    if wanted.supply_v is not None:
        for axis in chip.axes:
            axis.drive.plant.supply_v = wanted.supply_v
        chip.supply_changed()
    for one in wanted.axes:
        _change_axis(chip.axes[one.axis].drive, one)


def _change_axis(drive: Drive, wanted: AxisChange) -> None:
    plant = drive.plant
    change_load(plant, wanted)
    change_stage(plant, wanted.stage)
    force_switches(plant, wanted.switches)
    if wanted.encoder.slip_fullsteps is not None:
        plant.external_slip_fullsteps += wanted.encoder.slip_fullsteps


def describe(
    chip: Chip,
    model: Tmc5xxxModel,
    options: Tmc5xxxOptions,
    faults: ChipFaultsState,
    times: Times,
) -> Tmc5xxxState:
    """The chip and its bench as the API tells them."""
    uart, first = UartEnd(chip), chip.axes[0].drive
    return Tmc5xxxState(
        model=model,
        **times,
        clock_hz=options.clock_hz,
        rigid=options.rigid,
        supply_v=first.plant.supply_v,
        axes=[_describe_axis(chip, index) for index in range(chip.kind.axes)],
        position_compare=PositionCompareState(
            x_compare=first.x_compare,
            output=chip.position_compare,
            enabled=chip.shows_position_compare,
            passed=first.positions_passed,
        ),
        uart=UartState(node=uart.node, reply_delay_bits=uart.reply_delay_bits, writes=chip.ifcnt)
        if chip.kind.uart
        else None,
        pins=PinsState(drv_enn=chip.drv_enn, nextaddr=chip.node_pin, interrupt=chip.interrupt),
        faults=faults,
    )


def _describe_axis(chip: Chip, index: int) -> AxisState:
    drive = chip.axes[index].drive
    plant, state, switches = drive.plant, drive.plant_state, drive.switches
    encoder = EncoderState(
        counts=drive.external.counts,
        counts_per_turn=drive.external.counts_per_turn,
        connected=chip.encoder_connected(index),
        n_level=chip.encoder_lines(index)[2],
        slip_fullsteps=plant.external_slip_fullsteps,
    )
    return AxisState(
        axis=index,
        motor=motor_state(plant, drive.options.motor),
        load_torque_nm=plant.load_torque_nm,
        blocked=plant.blocked,
        friction=plant.extra_friction_nm,
        stage=stage_state(plant, state),
        switches=SwitchesState(
            left=SwitchState(active=switches.left, forced=plant.force_left),
            right=SwitchState(active=switches.right, forced=plant.force_right),
        ),
        encoder=encoder if chip.has_encoder else None,
        truth=truth_state(state),
    )
