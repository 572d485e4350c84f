"""What a study of torque over speed will do, and what is missing before it can."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ...devices.core.device import Device
from ...number_text import counted
from ..document import StudyDocument, TorqueCurve
from ..plan import Looked, StudyPlan, axis_seen_by, planned, room_told
from ..ramp_settings import ACCELERATION, JERK, SPEED, RampSpace
from ..switch_edge import LEAVING, SPANS_MAX, SWITCHES
from ..until_switch import Side

LOW_RPS = 2.0
"""The first speed: below it full steps and detent torque cannot be told from one another [turns/s]."""
ROOM_TURNS = 3.0
"""What a slip itself takes, and stopping [turns]."""
NEAR_TURNS = 2.0
"""So far to the other side a switch is looked for at most [turns]."""
RUN_S = 6.0
"""What a run takes with its way back and coming to rest, about [s]."""
FIRST_RUNS = 12
BRACKET_RUNS, RUN_BY_SWITCH_S = 5, 12.0
"""Runs that find where steps are lost, and what one takes with its way to the switch, about [s]."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. near, start, far, full_step, turn : [microsteps]; most : [pps, pps^2];
    switch : what sees lost steps, looked for up to `near`; None: the encoder does."""

    space: RampSpace
    switch: Side | None
    near: int
    start: int
    far: int
    full_step: int
    turn: int
    most: dict[str, float]

    @property
    def way(self) -> int:
        """To which side runs go first: 1 to positions above, -1 below."""
        return 1 if self.far > self.start else -1

    @property
    def periods(self) -> float:
        """Electrical periods of a turn."""
        return self.turn / (4 * self.full_step)

    def pps2(self, radps2: float) -> float:
        """An acceleration of the shaft in microsteps."""
        return radps2 / (2 * math.pi) * self.turn

    def radps2(self, pps2: float) -> float:
        """The other way round."""
        return pps2 * 2 * math.pi / self.turn


async def look(device: Device, axis: int, wanted: TorqueCurve) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    switch = SWITCHES[wanted.seen_by]
    found = await axis_seen_by(device, axis, looked.missing, switch, "without one nobody sees a rotor slip")
    if found is None:
        return looked
    space, state, turn = found.space, found.state, found.turn
    now, limits = space.now(), device.axes[axis].settings.limits
    if not all(now.values()):
        say("its speed or acceleration is 0: set a ramp at which it moves, for a start")
        return looked
    if JERK in now:
        say("its ramp is S-shaped: how hard it accelerates is up to its bows too. Set a ramp without them for this")
    way = -1 if switch == "right" else 1
    near, far = state.position, state.position + way * round(wanted.travel_turns * turn)
    if switch is not None:
        near -= way * round(NEAR_TURNS * turn)
        near -= limits.beyond(near)
    if limits.beyond(far):
        say(f"it would go to {far}, and the soft limits end before: begin elsewhere, or with less travel")
    looked.warnings += room_told(limits)
    if wanted.inertia_kgm2 is None:
        looked.warnings.append("the inertia is not told: what is found is the acceleration over speed, not the torque")
    speed = min(
        wanted.velocity_max_rps * turn,
        space.allowed(SPEED),
        device.motion.speed_limit_pps(axis),
    )
    if speed < 2 * LOW_RPS * turn:
        say(f"its speed is limited to {counted(speed / turn, 'turn')} a second: {2 * LOW_RPS:g} are needed")
    most = {SPEED: speed, ACCELERATION: space.allowed(ACCELERATION)}
    looked.ground = Ground(space, switch, near, state.position, far, found.full_step, turn, most)
    return looked


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(TorqueCurve)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, axis, wanted)

    return await planned("Torque over speed", look(device, axis, wanted), tell)


def _tell(told: StudyPlan, ground: Ground, axis: int, wanted: TorqueCurve) -> None:
    told.position_from, told.position_to = sorted((ground.near, ground.far))
    told.velocity_max_pps, told.acceleration_max_pps2 = ground.most[SPEED], ground.most[ACCELERATION]
    by_switch = ground.switch is not None
    runs = FIRST_RUNS + wanted.speeds * (wanted.repeats + BRACKET_RUNS * by_switch)
    told.moves_max = 2 * runs
    told.way_fullsteps = told.moves_max * abs(ground.far - ground.start) / ground.full_step
    told.time_s = (RUN_BY_SWITCH_S if by_switch else RUN_S) * runs
    told.registers = [f"{each.name} of axis {axis}" for each in ground.space.before]
    told.steps = _by_switch(ground, wanted) if by_switch else _by_slips(wanted)
    told.unwatched = [
        "a load that is out of step runs on until its friction has stopped it: give it room, most of all at high speed",
        "another switch on the way, wired to the same input; and one that fails: after lost steps it is looked for "
        f"slowly, {SPANS_MAX} times the whole way at most"
        if by_switch
        else "an encoder that slips on its shaft looks like lost steps",
        "what is behind a belt or a coupling that gives way has its share of the inertia only",
    ]


def _by_slips(wanted: TorqueCurve) -> list[str]:
    return [
        f"from {LOW_RPS:g} turns a second on the acceleration is raised until steps are lost, which is loud",
        "gently up, until steps are lost or the greatest speed is reached: how far there is something to find",
        f"{wanted.repeats} times at each of {wanted.speeds} speeds between, both ways in turn: up to it, then too hard",
        "how much the rotor accelerates as it slips is what the motor has",
        "after each slip the position is taken from the encoder, and the motor goes back slowly",
        "the setting as it is now goes back",
    ]


def _by_switch(ground: Ground, wanted: TorqueCurve) -> list[str]:
    return [
        f"to the {ground.switch} switch, {ground.near} at most: its edge is found by full steps",
        f"from rest to {LOW_RPS:g} turns a second or more, with more and more acceleration until steps are lost",
        "gently up to more and more speed, until steps are lost: how far there is something to find",
        f"to each of {wanted.speeds} speeds between, away from the switch, with more and less acceleration",
        f"between one that holds {wanted.repeats} times and one that loses steps is what the motor has",
        "to the edge of the switch after each run: elsewhere, steps were lost, and the position is set right",
        LEAVING,
        "the setting as it is now goes back",
    ]
