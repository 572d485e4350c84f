"""What a study of the least current will do, and what is missing before it can."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import plain
from ..current_settings import CurrentSpace
from ..document import LeastCurrent, StudyDocument, told_twin
from ..families import coolstep_of, current_of
from ..plan import AxisNow, Looked, StudyPlan, axis_that_sees_lost_steps, planned, room_told, twin_told
from ..proof import runs_for
from ..ramp_settings import ACCELERATION, SPEED, RampSpace
from ..record import Held
from ..twins.identified import why_no_amperes
from .cool_search import CYCLES as COOL_CYCLES
from .cool_search import HEAT_CYCLES, PAIRS, SETTINGS
from .cool_setting import CoolSpace
from .cycle import Cycle, faster

SEARCHES = 5
"""A bisection of 32 scales."""
MORE_SEARCHES = 5
"""One with more speed, and a bisection of how much more."""
BASELINE_CYCLES = 3
AROUND_S = 0.6
"""What a move there and back takes beside its ramps: coming to rest, and looking [s]."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. start, full_step : [microsteps]; faster : None where it cannot be tried;
    cool : None where CoolStep is not looked for, and why_not_cool says why it cannot be."""

    current: CurrentSpace
    space: RampSpace
    start: int
    full_step: int
    most: dict[str, float]
    room: float
    cycle: Cycle
    faster: Cycle | None
    cool: CoolSpace | None = None
    why_not_cool: str = ""

    @property
    def cycles(self) -> tuple[Cycle, ...]:
        """The faster one, and the load cycle."""
        return (self.cycle,) if self.faster is None else (self.faster, self.cycle)

    def ramp(self, cycle: Cycle) -> list[Held]:
        """What to write for a cycle: for the load cycle the ramp as it was, all of it."""
        return self.space.before if cycle is self.cycle else self.space.registers(cycle.ramp)

    def scaled(self, scale: int) -> list[Held]:
        """What to write for a run current scale; the one at rest is no more."""
        return self.current.registers(scale, min(scale, self.current.hold_scale))

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
        current = CurrentSpace(device, axis, current_of(device), found.held)
    except WrongState as error:
        say(str(error))
        return looked
    state, now, limits = found.state, found.space.now(), device.axes[axis].settings.limits
    if not all(now.values()):
        say("its speed or acceleration is 0: set the ramp of the load cycle first")
        return looked
    cycle = Cycle(wanted.distance, {name: now[name] for name in (SPEED, ACCELERATION)})
    begin = state.position + cycle.way * 4 * found.full_step
    if limits.beyond(begin + wanted.distance):
        say(f"it would go to {begin + wanted.distance}, beyond the soft limits: begin elsewhere, or go less far")
    looked.warnings += room_told(limits)
    if wanted.resistance_ohm is None or wanted.run_current_a is None:
        looked.warnings.append("resistance and present current are not told: the saving is a share, not in watts")
    most = {
        SPEED: min(found.space.allowed(SPEED), device.motion.speed_limit_pps(axis)),
        ACCELERATION: found.space.allowed(ACCELERATION),
    }
    end = limits.position_max if cycle.way > 0 else limits.position_min
    room = math.inf if end is None else abs(end - begin)
    more = faster(cycle, 1 + wanted.speed_margin, most, room) if wanted.speed_margin else None
    if wanted.speed_margin and (more is None or more.times < 0.99 * (1 + wanted.speed_margin)):
        held = "no more speed" if more is None else f"{100 * (more.times - 1):.0f} % more speed alone"
        looked.warnings.append(f"{held} can be tried, by limits: what a lower supply does is shown so far only")
    if told_twin(wanted.twin) is not None and (why := why_no_amperes(device, axis)):
        looked.warnings.append(f"no current is tried on a twin: {why}")
    cool, why = _cool(device, axis, wanted, found, cycle)
    if why:
        looked.warnings.append(f"CoolStep is not looked for: {why}")
    looked.ground = Ground(current, found.space, state.position, found.full_step, most, room, cycle, more, cool, why)
    return looked


def _cool(
    device: Device, axis: int, wanted: LeastCurrent, found: AxisNow, cycle: Cycle
) -> tuple[CoolSpace | None, str]:
    """CoolStep of the axis; None, and why, where it cannot work in the cycle."""
    if not wanted.coolstep:
        return None, ""
    places = coolstep_of(device)
    if places is None:
        return None, f"a {device.family.title} has none that a study sets"
    try:
        space = CoolSpace(device, axis, places, found.held, found.full_step)
    except WrongState as error:
        return None, str(error)
    why = space.why_not(cycle.peak)
    return (None, why) if why else (space, "")


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
    cycles = BASELINE_CYCLES + (SEARCHES + MORE_SEARCHES) * wanted.repeats + proof * len(ground.cycles)
    if ground.cool is not None:
        cycles += COOL_CYCLES + SETTINGS * (wanted.repeats + HEAT_CYCLES) + proof * len(ground.cycles)
    hardest = ground.cycles[0]
    far = ground.start + hardest.distance + hardest.way * ground.period
    told.position_from, told.position_to = min(ground.start, far), max(ground.start, far)
    told.velocity_max_pps, told.acceleration_max_pps2 = hardest.ramp[SPEED], hardest.ramp[ACCELERATION]
    told.moves_max = 2 * cycles
    told.way_fullsteps = told.moves_max * (abs(hardest.distance) + ground.period) / ground.full_step
    told.time_s = cycles * (2 * max(each.time_s for each in ground.cycles) + AROUND_S)
    told.registers = [each.name for each in (*ground.current.before, *ground.space.before)]
    told.registers += [] if ground.cool is None else [each.name for each in ground.cool.before]
    raised, more = "", list[str]()
    if ground.faster is not None:
        percent = f"{100 * (ground.faster.times - 1):.0f} % more speed"
        raised = f", and as many with {percent}"
        more.append(
            f"{wanted.repeats} with {percent}, over {abs(ground.faster.distance)} microsteps: where they lose steps, "
            "the supply limits, and not the current"
        )
    scales = ground.current.run_scale + 1
    twin = told_twin(wanted.twin)
    on_twin = [] if twin is None else [twin_told(twin, f"{scales} currents")]
    search = "less current by halves" if twin is None else "the least one that held there, then by halves"
    told.steps = [
        f"{BASELINE_CYCLES} load cycles (by {wanted.distance} microsteps and back, with the ramp as it is) at first",
        *more,
        *on_twin,
        f"{search}, {wanted.repeats} cycles each, until steps are lost",
        "after lost steps the position is taken from the encoder, and the motor goes back with the current as it was",
        f"{proof} cycles at {100 * wanted.margin:g} % less than what is chosen{raised}: none may lose a step",
        *_cool_steps(ground, proof),
        "the current as it is now goes back, whatever came of it; one click takes the lower one",
    ]
    told.unwatched = [
        "a load that is heavier than now, a lower supply, a warmer motor: the margins have to hold for them",
        "what the axis has to hold at rest: the hold current is lowered only where it lies above the new run current",
        "CoolStep changes the current by itself: with it on, the run current is its upper end",
        *(() if ground.cool is None else ("with CoolStep: a load that comes faster than the current rises",)),
    ]


def _cool_steps(ground: Ground, proof: int) -> list[str]:
    if ground.cool is None:
        return []
    told = (
        f"CoolStep at the run current that was found: the load value of the cycle, up to {SETTINGS} settings, the best "
        f"in {proof} cycles as above with less current that comes back later, then {PAIRS} with it against {PAIRS} "
        "without"
    )
    return [told]
