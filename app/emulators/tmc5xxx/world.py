"""The bench around a chip: what a patch does to it, and what there is to tell."""

from __future__ import annotations

from ...errors import OutOfRange, WrongState
from ..core.uart_end import UartEnd
from ..drive import Drive
from ..drive.bench import (
    ChipFaultsState,
    change_motor,
    change_stage,
    check_stage,
    forced,
    motor_state,
    places_of,
    stage_state,
    truth_state,
)
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
        if options.rigid and (axis.load_torque_nm or axis.friction or axis.blocked):
            raise WrongState("the motor is rigid", "make the emulator with a motor that has physics")
        check_stage(places_of(chip.axes[axis.axis].drive.world), axis.stage)


def change(chip: Chip, wanted: Tmc5xxxPatch) -> None:
    """Everything; it has been checked."""
    if wanted.pins.drv_enn is not None:
        chip.drv_enn = wanted.pins.drv_enn
    if wanted.pins.nextaddr is not None:
        chip.node_pin = wanted.pins.nextaddr
    if wanted.supply_v is not None:
        for axis in chip.axes:
            axis.drive.world.supply_v = wanted.supply_v
        chip.supply_changed()
    for one in wanted.axes:
        _change_axis(chip.axes[one.axis].drive, one)


def _change_axis(drive: Drive, wanted: AxisChange) -> None:
    world = drive.world
    change_motor(world, wanted.motor)
    if wanted.load_torque_nm is not None:
        world.load_torque_nm = wanted.load_torque_nm
    if wanted.friction is not None:
        world.extra_friction_nm = wanted.friction
    if wanted.blocked is not None:
        world.blocked = wanted.blocked
    change_stage(world, wanted.stage)
    if wanted.switches.left is not None:
        world.force_left = forced(wanted.switches.left)
    if wanted.switches.right is not None:
        world.force_right = forced(wanted.switches.right)
    if wanted.encoder.slip_fullsteps is not None:
        world.external_slip_fullsteps += wanted.encoder.slip_fullsteps


def describe(
    chip: Chip,
    model: Tmc5xxxModel,
    options: Tmc5xxxOptions,
    faults: ChipFaultsState,
    *,
    time_scale: float,
    chip_time_s: float,
    time_skipped_s: float,
) -> Tmc5xxxState:
    """The chip and its bench as the API tells them."""
    uart, first = UartEnd(chip), chip.axes[0].drive
    return Tmc5xxxState(
        model=model,
        time_scale=time_scale,
        chip_time_s=chip_time_s,
        time_skipped_s=time_skipped_s,
        clock_hz=options.clock_hz,
        rigid=options.rigid,
        supply_v=first.world.supply_v,
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
    world, truth, switches = drive.world, drive.truth, drive.switches
    encoder = EncoderState(
        counts=drive.external.counts,
        counts_per_turn=drive.external.counts_per_turn,
        connected=chip.encoder_connected(index),
        n_level=chip.encoder_lines(index)[2],
        slip_fullsteps=world.external_slip_fullsteps,
    )
    return AxisState(
        axis=index,
        motor=motor_state(world, drive.options.motor),
        load_torque_nm=world.load_torque_nm,
        blocked=world.blocked,
        friction=world.extra_friction_nm,
        stage=stage_state(world, truth),
        switches=SwitchesState(
            left=SwitchState(active=switches.left, forced=world.force_left),
            right=SwitchState(active=switches.right, forced=world.force_right),
        ),
        encoder=encoder if chip.has_encoder else None,
        truth=truth_state(truth),
    )
