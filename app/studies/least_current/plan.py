"""What a study of the least current will do, and what is missing before it can."""

from __future__ import annotations

from dataclasses import dataclass

from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import plain
from ..current_settings import CurrentSpace
from ..document import LeastCurrent, StudyDocument
from ..families import identification_of
from ..plan import Looked, StudyPlan, axis_that_sees_lost_steps, faults_told, planned, room_told
from ..proof import runs_for
from ..ramp_settings import ACCELERATION, SPEED, least_time_s

SEARCHES = 5
"""A bisection of 32 scales."""
BASELINE_CYCLES = 3
AROUND_S = 0.6
"""What a move there and back takes beside its ramps: coming to rest, and looking [s]."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. start, full_step : [microsteps]; move_s : of one move [s]."""

    current: CurrentSpace
    start: int
    full_step: int
    move_s: float
    ramp: dict[str, float]

    @property
    def period(self) -> int:
        """An electrical period: cycles begin at different places of it [microsteps]."""
        return 4 * self.full_step


async def look(device: Device, axis: int, wanted: LeastCurrent) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    found = await axis_that_sees_lost_steps(device, axis, looked.missing, "without one lost steps cannot be seen")
    if found is None:
        return looked
    try:
        current = CurrentSpace(device, axis, identification_of(device).current, found.held)
    except WrongState as error:
        say(str(error))
        return looked
    state, now, limits = found.state, found.space.now(), device.axes[axis].settings.limits
    if not all(now.values()):
        say("its speed or acceleration is 0: set the ramp of the load cycle first")
        return looked
    looked.missing += faults_told(device, axis, state)
    far = state.position + wanted.distance + (4 if wanted.distance > 0 else -4) * found.full_step
    if limits.beyond(far):
        say(f"it would go to {far}, and the soft limits end before: begin elsewhere, or by a shorter distance")
    looked.warnings += room_told(limits)
    if wanted.resistance_ohm is None or wanted.run_current_a is None:
        looked.warnings.append("resistance and present current are not told: the saving is a share, not in watts")
    move_s = least_time_s(wanted.distance, now[SPEED], now[ACCELERATION])
    looked.ground = Ground(current, state.position, found.full_step, move_s, now)
    return looked


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(LeastCurrent)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, wanted)
        if told.time_s > document.budget.time_s:
            told.warnings.append(f"its time of {plain(document.budget.time_s)} s ends before the proof: it needs more")

    return await planned("Least current", look(device, axis, wanted), tell)


def _tell(told: StudyPlan, ground: Ground, wanted: LeastCurrent) -> None:
    proof = runs_for(wanted.loss_rate_max)
    cycles = BASELINE_CYCLES + SEARCHES * wanted.repeats + proof
    way = 1 if wanted.distance > 0 else -1
    far = ground.start + wanted.distance + way * ground.period
    told.position_from, told.position_to = min(ground.start, far), max(ground.start, far)
    told.velocity_max_pps, told.acceleration_max_pps2 = ground.ramp[SPEED], ground.ramp[ACCELERATION]
    told.moves_max = 2 * cycles
    told.way_fullsteps = told.moves_max * (abs(wanted.distance) + ground.period) / ground.full_step
    told.time_s = cycles * (2 * ground.move_s + AROUND_S)
    told.registers = [each.name for each in ground.current.before]
    told.steps = [
        f"{BASELINE_CYCLES} load cycles (by {wanted.distance} microsteps and back, with the ramp as it is) at first",
        f"less current by halves, {wanted.repeats} cycles each, until steps are lost",
        "after lost steps the position is taken from the encoder, and the motor goes back with the current as it was",
        f"{proof} cycles at {100 * wanted.margin:g} % less than the current that is chosen: none may lose a step",
        "the current as it is now goes back, whatever came of it; one click takes the lower one",
    ]
    told.unwatched = [
        "a load that is heavier than now, a lower supply, a warmer motor: the margin has to hold for them",
        "what the axis has to hold at rest: the hold current is lowered only where it lies above the new run current",
        "CoolStep changes the current by itself: with it on, this is about its upper end",
    ]
