"""Where the fastest move is looked for: the space of speeds and accelerations, and what is missing before it can be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import counted, plain, times
from ..document import Budget, FastestMove, StudyDocument, told_twin
from ..families import shapes_of
from ..plan import AxisNow, Looked, StudyPlan, axis_seen_by, planned, room_told, twin_told
from ..proof import runs_for
from ..ramp_settings import ACCELERATION, SPEED, UNITS, RampSpace
from ..search import Dimension
from ..switch_edge import LEAVING, SPANS_MAX, SWITCHES
from ..until_switch import Side

FASTER, SLOWER = 10.0, 0.5
"""How far from the present setting is looked at most, where no limit says otherwise."""
AROUND_S = 0.6
"""What a move there and back takes beside its ramps: coming to rest, and looking [s]."""
WRITING_S = 0.1
"""What setting registers takes, about [s]."""
BASELINE_RUNS = 3
LOOKS = 3
"""So many times the moves, and their time, with the ways to a switch after each half of one."""


@dataclass(frozen=True, slots=True)
class Ranges:
    """What is known before the first move."""

    space: RampSpace
    dimensions: tuple[Dimension, ...]
    start: int
    microsteps: int
    """Of a full step."""
    period: int
    """An electrical period [microsteps]: runs begin at different places of it."""
    most: Mapping[str, float]
    """The greatest of each setting, less the margin [pps, pps^2, pps^3]."""
    near: int
    far: int
    """Where moves go at the most to the other side, where a switch is looked for, and to their own [microsteps]."""
    switch: Side | None
    """The switch that sees lost steps; None: the encoder does."""
    shapes: tuple[str, ...]
    """What of a ramp's shape could be searched."""

    def setting(self, asked: Mapping[str, float]) -> dict[str, float]:
        """The setting of what the search asks for: shares of others in their own units, within what they may be; the
        least, which is a trapezoid, where it asks for none."""
        found = dict(asked)
        for name, share in self.space.shares.items():
            times = asked.get(share.like or name, share.low)
            found[name] = min(times * found[share.of], self.most[name])
        return found

    def trapezoid(self, setting: Mapping[str, float]) -> dict[str, float]:
        """A setting whose shares of others are the least, which is a trapezoid."""
        found = dict(setting)
        for name, share in self.space.shares.items():
            found[name] = share.low * found[share.of]
        return found

    def asked(self, setting: Mapping[str, float], times: float = 1.0) -> dict[str, float]:
        """What the search would ask for to get that setting, `times` as fast, as far as its space goes. The least of
        all shares, which is a trapezoid, where they have no part in it."""
        shares = self.space.shares
        shaped = all(setting[name] for name in shares)
        found = {}
        for each in self.dimensions:
            share = shares.get(each.name)
            wanted = setting[each.name] * times
            if share is not None:
                wanted = setting[each.name] / setting[share.of] if shaped else each.low
            found[each.name] = min(max(wanted, each.low), each.high)
        return found


def _limits(device: Device, axis: int, wanted: FastestMove, space: RampSpace) -> dict[str, tuple[float, float]]:
    """The range of each setting that is no share of another [pps, pps^2, pps^3]."""
    soft, now = device.axes[axis].settings.limits, space.now()
    found = {}
    told = {
        SPEED: (soft.velocity_max_pps, wanted.velocity_max_pps),
        ACCELERATION: (soft.acceleration_max_pps2, wanted.acceleration_max_pps2),
    }
    for name in (each for each in now if each not in space.shares):
        limit, asked = told.get(name, (None, None))
        usual = limit if limit is not None else now[name] * FASTER
        most = min(usual if asked is None else asked, space.most(name), limit if limit is not None else float("inf"))
        if name == SPEED:
            most = min(most, device.motion.speed_limit_pps(axis))
        found[name] = (now[name] * SLOWER, most / (1 + wanted.margin))
    return found


def _shaped(device: Device, axis: int, wanted: FastestMove, found: AxisNow, missing: list[str]) -> RampSpace | None:
    """The space of the shape that is wanted; None where there is none, which is told."""
    ramps = shapes_of(device)
    if wanted.shape is None:
        return found.space
    if wanted.shape not in ramps:
        known = ", ".join(ramps) or "none"
        missing.append(f"{wanted.shape} cannot be searched on a {device.family.title} (but {known}): leave shape out")
        return None
    try:
        space = RampSpace(device, axis, ramps[wanted.shape], found.held)
    except WrongState as error:
        missing.append(str(error))
        return None
    if space.now().keys() != ramps[wanted.shape].settings.keys():
        missing.append(f"{wanted.shape} have no part in the ramp as it is set: set an S-ramp, or leave shape out")
        return None
    return space


def _misfit(candidate: Mapping[str, float], space: RampSpace, highs: Mapping[str, float]) -> str:
    """Why a setting cannot be proved on this axis; empty where it can."""
    if candidate.keys() != highs.keys():
        has, asked = ", ".join(sorted(highs)), ", ".join(sorted(candidate))
        return f"the candidate has {asked}, and a setting of this axis {has}"
    most = space.rounded(highs)
    for name, value in space.rounded(candidate).items():
        if value > most[name]:
            return (
                f"the candidate's {name} is {plain(value, 6)} {UNITS[name]}, and {plain(most[name], 6)} is the most "
                "here, by register and limits, less the margin: raise the limit, or take another setting"
            )
    return ""


def ramps_s(wanted: FastestMove, space: RampSpace, setting: Mapping[str, float]) -> float:
    """The least that moves by all its distances take, one way each [s]."""
    return sum(space.least_time_s(each, setting) for each in wanted.every_distance)


async def look(device: Device, axis: int, wanted: FastestMove) -> Looked[Ranges]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ranges]()
    say = looked.missing.append
    switch = SWITCHES[wanted.seen_by]
    found = await axis_seen_by(device, axis, looked.missing, switch, "without one lost steps cannot be seen")
    if found is None:
        return looked
    space, state, microsteps = _shaped(device, axis, wanted, found, looked.missing), found.state, found.full_step
    if space is None:
        return looked
    now = space.now()
    if not all(value for name, value in now.items() if name not in space.shares):
        say("its speed or acceleration is 0: set a ramp at which it moves, for a start")
        return looked
    try:
        space.least_time_s(wanted.distance, now)
    except ValueError as error:
        say(f"its ramp gets nowhere: {error}")
        return looked
    period, limits = 4 * microsteps, device.axes[axis].settings.limits
    way = wanted.farthest + (period if wanted.farthest > 0 else -period)
    near, far = state.position, state.position + way
    if switch is not None:
        near -= way + limits.beyond(near - way)
    for end in (state.position, far):
        if limits.beyond(end):
            say(f"it would go to {end}, and the soft limits end before: begin elsewhere, or by a shorter distance")
            break
    looked.warnings += room_told(limits)
    ranges = _limits(device, axis, wanted, space)
    for name, (low, high) in ranges.items():
        if high <= low:
            say(f"{name} has no range: from {plain(low)} to {plain(high)}; the limit, less the margin, lies too low")
            return looked
    looked.warnings += [
        f"{name} ends at {plain(space.most(name), 4)} {UNITS[name]}, as far as its register goes with the clock as "
        "it is divided: start the axis up for a faster ramp to have more room"
        for name in ranges
        if space.most(name) < now[name] * FASTER and ranges[name][1] == space.most(name) / (1 + wanted.margin)
    ]
    dimensions = tuple(Dimension(name, low, high) for name, (low, high) in ranges.items())
    dimensions += tuple(
        Dimension(name, share.low, share.high) for name, share in space.shares.items() if not share.like
    )
    # A share of a setting may be as much as that itself may be.
    most = {name: high for name, (_, high) in ranges.items()}
    for name, share in space.shares.items():
        most[name] = min(most[share.of], space.most(name) / (1 + wanted.margin))
    if wanted.candidate is not None and (wrong := _misfit(wanted.candidate, space, most)):
        say(wrong)
        return looked
    offered = tuple(shapes_of(device))
    looked.ground = Ranges(space, dimensions, state.position, microsteps, period, most, near, far, switch, offered)
    return looked


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(FastestMove)

    def tell(told: StudyPlan, ranges: Ranges) -> None:
        _tell(told, ranges, wanted, document.budget, axis)

    return await planned("Fastest move", look(device, axis, wanted), tell)


def _distances_told(wanted: FastestMove) -> str:
    if not wanted.distances:
        return f"{wanted.distance} microsteps"
    return f"each of {', '.join(str(each) for each in wanted.every_distance)} microsteps (their times are added up)"


def _tell(told: StudyPlan, ranges: Ranges, wanted: FastestMove, budget: Budget, axis: int) -> None:
    now, candidate = ranges.space.now(), wanted.candidate
    highs = ranges.most
    if candidate is not None:
        highs = {name: max(now[name] / (1 + wanted.margin), value) for name, value in candidate.items()}
    most = {name: high * (1 + wanted.margin) for name, high in highs.items()}
    trials = budget.trials if candidate is None else 1
    step_s, many = ramps_s(wanted, ranges.space, now), len(wanted.every_distance)
    alone = 0 if wanted.loss_rate_max is None else max(0, runs_for(wanted.loss_rate_max) - wanted.pairs)
    looks = 1 if ranges.switch is None else LOOKS
    runs = (
        BASELINE_RUNS + trials * (wanted.repeats + (wanted.repeats if wanted.quiet else 1)) + 3 * wanted.pairs + alone
    )
    share = (1 + wanted.margin) * 100
    way = sum(abs(each) + ranges.period for each in wanted.every_distance)
    told.moves_max = 2 * looks * runs * many
    told.way_fullsteps = 2 * looks * runs * way / ranges.microsteps
    whole_s = looks * runs * (2 * step_s + many * AROUND_S) + 2 * (trials + wanted.pairs) * WRITING_S
    told.time_s = min(budget.time_s, whole_s)
    if alone and budget.time_s < whole_s:
        told.warnings.append(
            f"the loss rate may not be shown within {plain(budget.time_s)} s: all moves together may take "
            f"{plain(whole_s, 2)} s; allow more time, or ask for a greater rate"
        )
    if budget.distance_fullsteps is not None:
        told.way_fullsteps = min(told.way_fullsteps, budget.distance_fullsteps)
    told.position_from, told.position_to = sorted((ranges.near, ranges.far))
    told.velocity_max_pps, told.acceleration_max_pps2 = most[SPEED], most[ACCELERATION]
    told.registers = [f"{each.name} of axis {axis}" for each in ranges.space.before]
    present = f"{plain(now[SPEED])} pps, {plain(now[ACCELERATION])} pps^2"
    twin = told_twin(wanted.twin)
    on_twin = [] if twin is None else [twin_told(twin, f"{twin.trials} settings")]
    by_switch = (
        []
        if ranges.switch is None
        else [
            f"to the {ranges.switch} switch, {ranges.near} at most: its edge is found by full steps",
            "to that edge after each half of a move, set as it is now: where it is elsewhere, steps were lost",
            LEAVING,
        ]
    )
    told.steps = [
        *by_switch,
        f"{BASELINE_RUNS} moves by {_distances_told(wanted)} and back, as the axis is set now: {present}",
        *on_twin,
        f"{_tried_told(candidate, trials)}: {times(wanted.repeats)} there and back {share:g} % as fast, then as it is",
        *([] if candidate else _shape_told(ranges, wanted)),
        "beyond the edge steps will be lost, which is loud",
        f"after lost steps the position is taken from the {wanted.seen_by}, and the motor goes back slowly",
        *_proposal_told(wanted),
        f"{wanted.pairs} moves with the old and {wanted.pairs} with the best setting, in turn; as many with margin",
        *([f"{alone} more with the best setting alone, if it is better: none may lose a step"] if alone else []),
        "the setting as it is now goes back, whatever came of it; one click takes the best one",
    ]
    told.unwatched = (
        [
            "an encoder that slips on its shaft looks like lost steps",
            "what is behind the motor's shaft (a belt that jumps) is not seen by an encoder on that shaft",
        ]
        if ranges.switch is None
        else [
            "how long the shaft rings at the end of a move: without an encoder a move is over when its ramp is",
            "a belt that jumps, or a switch that has moved, looks like lost steps",
            f"a switch that fails: after lost steps it is looked for slowly, {SPANS_MAX} times the whole way at most",
        ]
    )


def _shape_told(ranges: Ranges, wanted: FastestMove) -> list[str]:
    """What becomes of the ramp's shape."""
    if wanted.shape is not None:
        return [f"of each setting the shape ({wanted.shape}) is searched too: {', '.join(ranges.space.now())}"]
    told = []
    if ranges.space.off:
        told.append(f"{' and '.join(ranges.space.off)} set to 0 with them: each is a trapezoid")
    if ranges.shapes:
        told.append(f"the ramp's shape is not searched; it could be: {', '.join(ranges.shapes)}")
    return told


def _tried_told(candidate: Mapping[str, float] | None, trials: int) -> str:
    if candidate is None:
        return f"up to {counted(trials, 'setting')}"
    return "the setting " + ", ".join(f"{plain(value, 4)} {UNITS[name]}" for name, value in candidate.items())


def _proposal_told(wanted: FastestMove) -> list[str]:
    """Which setting of the front of two objectives is the best one."""
    if not wanted.quiet or wanted.candidate is not None:
        return []
    if (most := wanted.deviation_max_fullsteps) is not None:
        return [f"the best is the fastest that never deviates by more than {plain(most, 3)} full steps under way"]
    return ["the best, of those that are faster, is nearest to the least time and the least deviation of them"]
