"""What a study of torque over speed will do, and what is missing before it can."""

from __future__ import annotations

from dataclasses import dataclass

from ...devices.core.device import Device
from ...number_text import plain
from ..document import StudyDocument, TorqueCurve
from ..plan import Looked, StudyPlan, axis_that_sees_lost_steps, faults_told, planned, room_told
from ..ramp_settings import ACCELERATION, SPEED, RampSpace

LOW_RPS = 2.0
"""The first speed: below it full steps and detent torque cannot be told from one another [turns/s]."""
ROOM_TURNS = 3.0
"""What a slip itself takes, and stopping [turns]."""
RUN_S = 6.0
"""What a run takes with its way back and coming to rest, about [s]."""
FIRST_RUNS = 12


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. start, far, full_step, turn : [microsteps]; most : [pps, pps^2]."""

    space: RampSpace
    start: int
    far: int
    full_step: int
    turn: int
    most: dict[str, float]

    @property
    def periods(self) -> float:
        """Electrical periods of a turn."""
        return self.turn / (4 * self.full_step)


async def look(device: Device, axis: int, wanted: TorqueCurve) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    found = await axis_that_sees_lost_steps(device, axis, looked.missing, "without one nobody sees a rotor slip")
    if found is None:
        return looked
    space, state, turn = found.space, found.state, found.turn
    now, limits = space.now(), device.axes[axis].settings.limits
    if not all(now.values()):
        say("its speed or acceleration is 0: set a ramp at which it moves, for a start")
        return looked
    looked.missing += faults_told(device, axis, state)
    far = state.position + round(wanted.travel_turns * turn)
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
        say(f"its speed is limited to {plain(speed / turn)} turns a second: {2 * LOW_RPS:g} are needed")
    most = space.allowed(ACCELERATION)
    looked.ground = Ground(space, state.position, far, found.full_step, turn, {SPEED: speed, ACCELERATION: most})
    return looked


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(TorqueCurve)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, axis, wanted)

    return await planned("Torque over speed", look(device, axis, wanted), tell)


def _tell(told: StudyPlan, ground: Ground, axis: int, wanted: TorqueCurve) -> None:
    told.position_from, told.position_to = ground.start, ground.far
    told.velocity_max_pps, told.acceleration_max_pps2 = ground.most[SPEED], ground.most[ACCELERATION]
    told.moves_max = 2 * (FIRST_RUNS + wanted.speeds * wanted.repeats)
    told.way_fullsteps = told.moves_max * (ground.far - ground.start) / ground.full_step
    told.time_s = RUN_S * (FIRST_RUNS + wanted.speeds * wanted.repeats)
    told.registers = [f"{each.name} of axis {axis}" for each in ground.space.before]
    told.steps = [
        f"from {LOW_RPS:g} turns a second on the acceleration is raised until steps are lost, which is loud",
        "gently up, until steps are lost or the greatest speed is reached: how far there is something to find",
        f"{wanted.repeats} times at each of {wanted.speeds} speeds between, both ways in turn: up to it, then too hard",
        "how much the rotor accelerates as it slips is what the motor has",
        "after each slip the position is taken from the encoder, and the motor goes back slowly",
        "the setting as it is now goes back",
    ]
    told.unwatched = [
        "a load that is out of step runs on until its friction has stopped it: give it room, most of all at high speed",
        "an encoder that slips on its shaft looks like lost steps",
        "what is behind a belt or a coupling that gives way has its share of the inertia only",
    ]
