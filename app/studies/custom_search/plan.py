"""What an own search will do, and what is missing before it can."""

from __future__ import annotations

from dataclasses import dataclass

from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import counted, plain, times
from ..document import CustomSearch, StudyDocument
from ..plan import Looked, StudyPlan, axis_that_sees_lost_steps, planned, room_told
from ..ramp_settings import ACCELERATION, SPEED, least_time_s
from .figures import NAMES, sign_of
from .space import CustomSpace, Refused, Searched, beyond_limits

FINALISTS, AGAIN = 4, 2
"""So many of the best are measured again, so many times what a trial is: the least of many is least by luck, too.
Then they go to the proof, one after the other, where one of them does not hold there."""
AROUND_S = 0.4
"""What a move takes beside its ramp: coming to rest, and looking [s]."""
WRITING_S = 0.1
"""What setting registers takes, about [s]."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. start, full_step, period : [microsteps]; load : whether load values are
    told."""

    space: CustomSpace
    start: int
    full_step: int
    load: bool

    @property
    def period(self) -> int:
        """An electrical period: runs begin at different places of it."""
        return 4 * self.full_step

    def places(self, count: int) -> list[int]:
        """So many places of the electrical period, evenly apart, the same for each setting."""
        return [self.period * index // count for index in range(count)]

    def far(self, distance: int) -> int:
        """Where moves by a distance go at the most."""
        return self.start + distance + (self.period if distance > 0 else -self.period)

    def time_s(self, wanted: CustomSearch, values: dict[str, float]) -> float:
        """About what all moves take once with a setting [s]; `inf` where one of them never ends."""
        ramp = self.space.ramp_with(values)
        if min(ramp[SPEED], ramp[ACCELERATION]) <= 0:
            return float("inf")
        moves = [least_time_s(distance, ramp[SPEED], ramp[ACCELERATION]) for distance in wanted.distances]
        return 2 * (sum(moves) + len(moves) * AROUND_S)


async def look(device: Device, axis: int, wanted: CustomSearch) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    found = await axis_that_sees_lost_steps(device, axis, looked.missing, "without one lost steps cannot be seen")
    if found is None:
        return looked
    if not all(found.space.now().values()):
        say("its speed or acceleration is 0: set a ramp at which it moves, for a start")
        return looked
    try:
        space = CustomSpace(device, axis, found, wanted)
        looked.missing += await beyond_limits(device, space)
    except (Refused, WrongState) as error:
        say(str(error))
        return looked
    load = f"load_value.{axis}" in {channel.name for channel in device.telemetry.channels()}
    asked = {*wanted.objectives, *(bound.figure for bound in wanted.bounds)}
    if "load_min" in asked and not load:
        say("this axis tells no load value: leave load_min out")
    ground = Ground(space, found.state.position, found.full_step, load)
    limits = device.axes[axis].settings.limits
    for distance in wanted.distances:
        if limits.beyond(ground.far(distance)):
            say(
                f"it would go to {ground.far(distance)}, and the soft limits end before: begin elsewhere, or by a "
                "shorter distance"
            )
    looked.warnings += [*space.warnings, *room_told(limits)]
    looked.warnings += [
        f"{each.name} is {plain(each.now)} {each.unit}".rstrip() + " now, outside of its range"
        for each in space.settings
        if not each.dimension.low - 1e-6 * abs(each.now) <= each.now <= each.dimension.high + 1e-6 * abs(each.now)
    ]
    looked.ground = ground
    return looked


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(CustomSearch)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, document, axis)

    return await planned("Own search", look(device, axis, wanted), tell)


def _range(each: Searched) -> str:
    ends = (each.low, each.high) if not each.unit else (each.dimension.low, each.dimension.high)
    return f"{each.name} from {plain(ends[0])} to {plain(ends[1])} {each.unit}".rstrip()


def _tell(told: StudyPlan, ground: Ground, document: StudyDocument, axis: int) -> None:
    wanted, budget = document.wanted(CustomSearch), document.budget
    settings = ground.space.settings
    rounds = wanted.repeats * (budget.trials + 1 + FINALISTS * AGAIN) + 2 * wanted.pairs
    way = sum(abs(distance) for distance in wanted.distances)
    told.moves_max = 2 * rounds * len(wanted.distances)
    told.way_fullsteps = 2 * rounds * way / ground.full_step
    if budget.distance_fullsteps is not None:
        told.way_fullsteps = min(told.way_fullsteps, budget.distance_fullsteps)
    slowest = {each.name: each.dimension.low for each in settings}
    fastest = {each.name: each.dimension.high for each in settings}
    now_s = ground.time_s(wanted, ground.space.now)
    longest_s = max(now_s, ground.time_s(wanted, slowest))
    proof_s = 2 * wanted.pairs * (now_s + WRITING_S)
    trials = budget.trials + FINALISTS * AGAIN
    told.time_s = min(budget.time_s, wanted.repeats * (now_s + trials * longest_s) + proof_s)
    if told.time_s == budget.time_s:
        told.warnings.append(
            f"its time of {plain(budget.time_s)} s may end before all trials: a quarter of it is kept for the proof"
        )
    ends = [ground.start, *(ground.far(distance) for distance in wanted.distances)]
    told.position_from, told.position_to = min(ends), max(ends)
    ramps = [ground.space.ramp_with(values, max) for values in (ground.space.now, fastest)]
    told.velocity_max_pps = max(each[SPEED] for each in ramps)
    told.acceleration_max_pps2 = max(each[ACCELERATION] for each in ramps)
    told.registers = [f"{each.name} of axis {axis}" for each in ground.space.before]
    moves = ", ".join(str(distance) for distance in wanted.distances)
    goals = " and ".join(
        f"{'more' if sign_of(figure) < 0 else 'less'} {NAMES[figure][0]}" for figure in wanted.objectives
    )
    bounds = [
        f"{NAMES[bound.figure][0]}"
        + (f" at least {plain(bound.least)}" if bound.least is not None else "")
        + (f" at most {plain(bound.most)}" if bound.most is not None else "")
        for bound in wanted.bounds
    ]
    ranges = "; ".join(_range(each) for each in settings)
    told.steps = [
        f"moves by {moves} microsteps and back, {times(wanted.repeats)}, as the axis is set now",
        f"the same with up to {counted(budget.trials, 'setting')}, looking for {goals}: {ranges}",
        *([f"a setting counts with {', '.join(bounds)}"] if bounds else []),
        "after lost steps, which are loud, the position is taken from the encoder, and it goes back as set before",
        f"the best {FINALISTS} again, {AGAIN * wanted.repeats} times",
        f"{wanted.pairs} times all moves with the old and with the best setting, in turn",
        "the setting as it is now goes back, whatever came of it; one click takes the best one",
    ]
    told.unwatched = [
        "an encoder that slips on its shaft looks like lost steps",
        "how warm driver and motor become by a setting",
        "a load that hangs may sink where a setting holds it with less current",
    ]
