"""What a scored move will do, what is missing before it can, and the setting that it is made with."""

from __future__ import annotations

from dataclasses import dataclass

from ...devices.core.capabilities import EncoderSetting
from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import times
from ..document import ScoredMove, StudyDocument
from ..plan import Looked, StudyPlan, axis_now, planned, room_told
from ..ramp_settings import ACCELERATION, SPEED, UNITS, least_time_s
from ..record import Held
from .in_force import in_force, stall_level

AROUND_S = 0.4
"""What a move takes beside its ramp: coming to rest, and looking [s]."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. start, full_step : [microsteps]; move_s : of one move [s]; setting,
    registers : what is in force; stall_level : the load value at or below which is a stall, None where nobody knows."""

    start: int
    full_step: int
    move_s: float
    ramp: dict[str, float]
    setting: dict[str, float]
    registers: list[Held]
    stall_level: float | None


async def look(device: Device, axis: int, wanted: ScoredMove) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    found = await axis_now(device, axis, looked.missing)
    if found is None:
        return looked
    try:
        device.need(EncoderSetting).require_encoder(axis)
    except WrongState as error:
        say(str(error))
        return looked
    state, now, limits = found.state, found.space.now(), device.axes[axis].settings.limits
    if state.encoder_position is None:
        say("no encoder tells its position: nothing else sees how it moves")
    if not all(now.values()):
        say("its speed or acceleration is 0: set a ramp at which it moves")
        return looked
    far = state.position + wanted.distance
    if limits.beyond(far):
        say(f"it would go to {far}, and the soft limits end before: begin elsewhere, or by a shorter distance")
    looked.warnings += room_told(limits)
    hand = await in_force(device, axis, found.held)
    setting = {f"{name} [{UNITS[name]}]": value for name, value in now.items()} | dict(hand.values)
    registers = {(each.name, each.axis): each for each in (*found.space.before, *hand.registers)}
    move_s = least_time_s(wanted.distance, now[SPEED], now[ACCELERATION])
    looked.ground = Ground(
        state.position,
        found.full_step,
        move_s,
        now,
        setting,
        list(registers.values()),
        stall_level(device, axis, found.held, found.full_step),
    )
    return looked


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What it would do. Nothing moves."""
    wanted = document.wanted(ScoredMove)

    def tell(told: StudyPlan, ground: Ground) -> None:
        far = ground.start + wanted.distance
        told.position_from, told.position_to = min(ground.start, far), max(ground.start, far)
        told.velocity_max_pps, told.acceleration_max_pps2 = ground.ramp[SPEED], ground.ramp[ACCELERATION]
        told.moves_max = 2 * wanted.repeats
        told.way_fullsteps = told.moves_max * abs(wanted.distance) / ground.full_step
        told.time_s = told.moves_max * (ground.move_s + AROUND_S)
        told.steps = [
            f"by {wanted.distance} microsteps and back, {times(wanted.repeats)}, with all settings as they are now",
            "where a stall stops it on the way there, it goes back to where it began, and makes no further move",
            "its figures are kept with these settings: change some, move again, and compare",
        ]
        told.unwatched = ["lost steps are told, and not mended: the encoder shows where it stands"]

    return await planned("Scored move", look(device, axis, wanted), tell)
