"""What the study of StallGuard will do, and what is missing before it can."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import counted, plain
from ..document import StallGuard, StudyDocument
from ..families import stalls_of
from ..plan import Looked, StudyPlan, axis_that_sees_lost_steps, planned
from ..ramp_settings import ACCELERATION, SPEED, RampSpace, held_of
from .setting import StallPlaces, StallSpace

FIND_RPS = 0.25
"""How fast the stop is looked for at most [turns of the motor a second]."""
MEASURED_FREE, MEASURED_STOPS = 40, 20
"""Runs that a threshold is chosen by, at each speed."""
STOP_MOVES = 3
"""Of a run into the stop: to where it begins, there, and back."""
LOOKING_MOVES = 20
"""By which it looks at each speed where the load values lie, about."""
ROOM_FULLSTEPS = 12.0
"""What free runs keep from the stop."""
WHY_ENCODER = "without an encoder nothing tells when the motor is at the stop"


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. start, limit : [microsteps], `limit` where the search for the stop ends;
    way : the sign of the stop's side; full_step, turn : [microsteps]; speeds_pps : the asked ones."""

    ramp: RampSpace
    stall: StallSpace
    start: int
    limit: int
    way: int
    full_step: int
    turn: int
    speeds_pps: tuple[float, ...]
    acceleration_pps2: float

    @property
    def find_pps(self) -> float:
        """How fast the stop is looked for."""
        return min(FIND_RPS * self.turn, self.speeds_pps[0])


async def look(device: Device, axis: int, wanted: StallGuard) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    try:
        places = stalls_of(device)
    except WrongState as error:
        say(str(error))
        return looked
    found = await axis_that_sees_lost_steps(device, axis, looked.missing, WHY_ENCODER)
    if found is None:
        return looked
    state = found.state
    try:
        stall = await _space(device, axis, wanted, places, found.full_step)
    except WrongState as error:
        say(str(error))
        return looked
    if not wanted.stop_confirmed:
        say("nobody has said that a hard stop is there which the motor may run into: stop_confirmed")
    limits = device.axes[axis].settings.limits
    way = -1 if wanted.side == "left" else 1
    limit = state.position + way * round(wanted.within_fullsteps * found.full_step)
    if limits.beyond(limit):
        say(f"it would look for the stop as far as {limit}, and the soft limits end before")
    acceleration = found.space.now()[ACCELERATION]
    if not acceleration:
        say("its acceleration is 0: set a ramp at which it moves")
    speeds = tuple(speed * found.turn for speed in wanted.speeds_rps)
    most = min(limits.velocity_max_pps or float("inf"), device.motion.speed_limit_pps(axis), found.space.most(SPEED))
    if speeds[-1] > most:
        say(f"{plain(speeds[-1])} pps is faster than the axis may go, {plain(most)}")
    looked.warnings += [f"{line}: it is during the study, and with what is found" for line in stall.unfit()]
    looked.ground = Ground(
        found.space, stall, state.position, limit, way, found.full_step, found.turn, speeds, acceleration
    )
    return looked


async def _space(
    device: Device, axis: int, wanted: StallGuard, places: Sequence[StallPlaces], full_step: int
) -> StallSpace:
    """Of the generation that is asked for, else of that which the chopper is set for. Raises WrongState."""
    held = await held_of(device)
    spaces, refused = [], None
    for each in places:
        if wanted.generation in (None, each.generation):
            try:
                spaces.append(StallSpace(device, axis, each, held, full_step))
            except WrongState as error:
                refused = refused or error
    if not spaces:
        assert refused is not None
        raise refused
    return min(spaces, key=lambda space: space.misfits)


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(StallGuard)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, wanted)
        if told.time_s > document.budget.time_s:
            told.warnings.append(f"that takes longer than the {plain(document.budget.time_s)} s of its budget")

    return await planned("StallGuard threshold", look(device, axis, wanted), tell)


@dataclass(frozen=True, slots=True)
class Cost:
    """What runs at one speed cost, at most."""

    moves: int
    way_fullsteps: float
    time_s: float


def _cost(ground: Ground, wanted: StallGuard, speed_pps: float, free_runs: int, stops: int) -> Cost:
    """Of so many free runs, each of them a way of its own where the stop is near, and so many into the stop."""
    way = free_runs * wanted.run_fullsteps
    return Cost(
        free_runs + STOP_MOVES * stops,
        way + 2 * stops * min(abs(ground.limit - ground.start) / ground.full_step, wanted.run_fullsteps),
        way * ground.full_step / speed_pps + stops * (2.0 + 4 * speed_pps / ground.acceleration_pps2),
    )


def _tell(told: StudyPlan, ground: Ground, wanted: StallGuard) -> None:
    way = abs(ground.limit - ground.start) / ground.full_step
    measuring = [_cost(ground, wanted, speed, MEASURED_FREE, MEASURED_STOPS) for speed in ground.speeds_pps]
    proving = [_cost(ground, wanted, speed, wanted.free_runs, wanted.stops) for speed in ground.speeds_pps]
    # One speed at the least has the threshold that was chosen: all others may need one of their own.
    own = sorted(proving, key=lambda cost: cost.time_s)[1:] if wanted.each_speed else []
    costs = [*measuring, *proving, *own]
    told.position_from, told.position_to = sorted((ground.start, ground.limit))
    told.velocity_max_pps, told.acceleration_max_pps2 = ground.speeds_pps[-1], ground.acceleration_pps2
    told.moves_max = sum(cost.moves for cost in costs) + LOOKING_MOVES * len(measuring)
    told.way_fullsteps = sum(cost.way_fullsteps for cost in costs) + 2 * way
    told.time_s = way * ground.full_step / ground.find_pps + sum(cost.time_s for cost in costs)
    told.registers = [
        each.name if each.axis is None else f"{each.name} of axis {each.axis}"
        for each in (*ground.ramp.before, *ground.stall.before)
    ]
    speeds = counted(wanted.speeds_rps, "turn")
    measured = (
        f"at {speeds} a second each: {MEASURED_FREE} free runs between here and the stop, and {MEASURED_STOPS} "
        "into the stop, with the current as it is set; no stall stops the motor then: it grinds for "
        f"{plain(wanted.push_fullsteps)} full steps"
    )
    proved = (
        f"the best threshold again, and a stall stops the motor: {wanted.free_runs} free runs and {wanted.stops} into "
        "the stop at each speed, none of which the choice has seen"
    )
    moves, own_s = sum(cost.moves for cost in own), round(sum(cost.time_s for cost in own))
    more = (
        "where that does not hold at a speed, the one that suits it, proved there in the same way: at most "
        f"{moves} moves and {own_s} s more, counted in what the plan tells; none with each_speed off"
    )
    told.steps = [
        f"slowly to the {wanted.side} until it stands at the stop, {plain(wanted.within_fullsteps)} full steps at most",
        measured,
        proved,
        *([more] if own else []),
        "each threshold that these runs refute costs as much again at most, and the budget ends it",
        "after each lost step the position is taken from the encoder",
        "the setting as it is now goes back, whatever came of it; one click takes the best one",
    ]
    told.unwatched = [
        "whether the stop and what hangs on the motor bear it: the speed and the current are as asked",
        "another load, current, supply or temperature needs another threshold",
    ]
