"""What a study of the closed loop will do, and what is missing before it can."""

from __future__ import annotations

from dataclasses import dataclass

from ...devices.core.capabilities import EncoderSetting, VelocityJumps
from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import plain
from ..document import ClosedLoop, StudyDocument
from ..families import loop_of
from ..plan import Looked, StudyPlan, axis_now, planned, room_told
from ..ramp_settings import SPEED, RampSpace
from ..record import Held
from ..ringing import HOP_PPS, HOPS, RING_S
from .setting import LoopSpace, regulation_now

STEP_S = 1.0
SHOWN = 4
"""Steps that show a loop where nothing regulated before."""
LOADED = 2
"""Ramps, there and back, that load a loop by what accelerates."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move [microsteps]. span : how far hops and ramps go to positions above; jump_pps :
    of hops and steps [pps]; moving : shape and speed of the ramp, which these replace until the next move"""

    ramp: RampSpace
    loop: LoopSpace
    start: int
    full_step: int
    step: int
    span: int
    jump_pps: float
    most_pps: float
    moving: list[Held]


async def look(device: Device, axis: int, wanted: ClosedLoop) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    found = await axis_now(device, axis, looked.missing)
    if found is None:
        return looked
    state, full_step = found.state, found.full_step
    try:
        places = loop_of(device)
        device.need(EncoderSetting).require_encoder(axis)
        device.need(VelocityJumps)
        loop = LoopSpace(device, axis, places, found.held, await regulation_now(device, axis, places))
    except WrongState as error:
        say(str(error))
        return looked
    if state.encoder_position is None:
        say("no encoder tells its position: nothing could be regulated by it")
    if not (loop.on or loop.off):
        say("another regulation is on (regulation_modus): switch it off on the page Closed loop first")
    limits = device.axes[axis].settings.limits
    step = round(wanted.step_fullsteps * full_step)
    span = hop_span(full_step, wanted.hops)
    far = state.position + max(span, 2 * step + full_step)
    for end in (state.position - step, far):
        if limits.beyond(end):
            say(f"it would turn to {end}, and the soft limits end before: begin elsewhere")
    looked.warnings += room_told(limits)
    most = found.space.allowed(SPEED)
    speed = [each for each in found.space.before if each.name in found.space.names(SPEED)]
    jump_pps = min(HOP_PPS, most)
    looked.ground = Ground(
        found.space, loop, state.position, full_step, step, span, jump_pps, most, [loop.shape, *speed]
    )
    return looked


def hop_span(full_step: int, hops: int) -> int:
    """How far hops go to positions above [microsteps]."""
    return sum(round(HOPS[index % len(HOPS)] * full_step) for index in range(hops // 2))


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(ClosedLoop)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, axis, wanted)

    return await planned("Closed loop", look(device, axis, wanted), tell)


def _tell(told: StudyPlan, ground: Ground, axis: int, wanted: ClosedLoop) -> None:
    steps = 2 * wanted.pairs if ground.loop.on else SHOWN
    span = ground.span
    told.position_from = ground.start - ground.step
    told.position_to = ground.start + max(span, 2 * ground.step + ground.full_step)
    told.velocity_max_pps = ground.most_pps
    told.moves_max = wanted.hops + steps + LOADED + 2
    told.way_fullsteps = ((2 + LOADED) * span + steps * ground.step) / ground.full_step
    told.time_s = wanted.hops * (RING_S + 0.1) + steps * (STEP_S + 0.2) + LOADED + 2
    told.registers = [f"{each.name} of axis {axis}" for each in ground.loop.before]
    told.registers.append(f"regulation_modus of axis {axis}")
    told.steps = [
        f"{wanted.hops} hops without regulation, of about three quarters of a full step: the rotor rings out",
        f"P and I, no D, that keep {plain(wanted.phase_margin_deg)} deg and a factor of {plain(wanted.gain_margin)}",
        f"{wanted.pairs} steps with the old gains and as many with the new, in turn"
        if ground.loop.on
        else f"{SHOWN} steps of {plain(wanted.step_fullsteps)} full steps, there and back, with the loop on",
        "where they do as was asked: a ramp there and back, whose acceleration loads the loop; and a grade",
        "the new gains stay, and the loop on, where they do as was asked; else all goes back"
        if wanted.keep
        else "all goes back, whatever came of it; one click takes the new gains, with the loop off",
    ]
    told.unwatched = [
        "the margins under another load: a greater inertia has a slower resonance, and leaves less of them",
        "an answer to another load than its own acceleration: push it, by hand or emulated (Closed loop, Disturbance)",
    ]
