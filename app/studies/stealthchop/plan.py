"""What a study of StealthChop will do, and what is missing before it can."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import counted, plain
from ..current_settings import CurrentSpace
from ..document import QuietStealthChop, StudyDocument
from ..families import current_of, stealthchop_of
from ..plan import Looked, StudyPlan, axis_that_sees_lost_steps, planned, room_told
from ..ramp_settings import ACCELERATION, SPEED, RampSpace
from .setting import Motor, StealthSpace

SPEED_UP_S = 0.4
"""How long runs speed up and brake [s]."""
FAST_S = 0.1
"""At their greatest speed [s]."""
AROUND_S = 0.7
"""What a run takes beside its way, with the settings before it [s]."""
LEAST_RPS, TIMES = 0.1, 1.4
"""The slowest switch-over that is tried, and the next one over it."""
PARTS = 4
"""Between two of them more are tried, so many parts of the step apart. They are the same wherever a study begins: what
has jolted once is not come upon again a little beside."""
TOP = 1.15
"""So many times the switch-over speed is the greatest speed at least."""
PLACES = 4
"""Runs of a setting begin at so many places of a full step, evenly: where in it the choppers change makes the jolt a
quarter larger or smaller."""
TUNING_RPS = (0.5, 0.75, 1.0, 1.5, 2.2, 3.3)
NEEDED_RPS = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Where it is seen what amplitude a turn needs [turns a second]."""
NEEDED_TURNS = 0.75
TUNING_TURNS = 1.5
TUNING_RUNS = 12
"""Of ways at one speed until what velocity adds does not change, at most."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. start, full_step, turn : [microsteps]; through : a run through all speeds,
    there or back; turns : the ones at constant speed, each with its speed [turns a second]."""

    ramp: RampSpace
    current: CurrentSpace
    stealth: StealthSpace
    start: int
    full_step: int
    turn: int
    top_rps: float
    through: dict[str, float]
    length: int
    turns: tuple[tuple[float, dict[str, float]], ...]

    @property
    def before(self) -> list[str]:
        return [each.name for each in (*self.ramp.before, *self.current.before, *self.stealth.before)]

    @property
    def round_s(self) -> float:
        """There and back [s]."""
        return 2 * (2 * SPEED_UP_S + FAST_S + AROUND_S)

    @property
    def hold_scale(self) -> int:
        """Current at rest between runs: less than the run current, with which the chip would tune itself there."""
        return min(self.current.hold_scale, self.current.run_scale // 2)

    @property
    def switches_rps(self) -> list[float]:
        """Switch-over speeds that may be tried, rising."""
        count = 1 + math.floor(math.log(self.top_rps / TOP / LEAST_RPS) / math.log(TIMES))
        return [LEAST_RPS * TIMES**index for index in range(count)]

    @property
    def needed_rps(self) -> list[float]:
        """Where it is seen what amplitude a turn needs."""
        return [each for each in NEEDED_RPS if each <= self.top_rps]

    @property
    def needed_way(self) -> int:
        """Of a run there [microsteps]."""
        return round(NEEDED_TURNS * self.turn)

    @property
    def tuning_way(self) -> int:
        """Of a run at constant speed [microsteps]."""
        return round(TUNING_TURNS * self.turn)


def between_of(held_rps: float, above_rps: float) -> float | None:
    """The switch-over speed in the middle of one that held and one that did not; None: there is no further one."""
    low, high = (PARTS * math.log(each / LEAST_RPS) / math.log(TIMES) for each in (held_rps, above_rps))
    middle = round((low + high) / 2)
    return LEAST_RPS * TIMES ** (middle / PARTS) if low + 0.5 < middle < high - 0.5 else None


async def look(device: Device, axis: int, wanted: QuietStealthChop) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    why = "nothing else sees the shaft jolt, or lose a step"
    found = await axis_that_sees_lost_steps(device, axis, looked.missing, why)
    if found is None:
        return looked
    state, full_step, turn = found.state, found.full_step, found.turn
    try:
        current = CurrentSpace(device, axis, current_of(device), found.held)
        motor = Motor(
            wanted.resistance_ohm,
            wanted.inductance_h,
            wanted.run_current_a,
            wanted.supply_v,
            device.session.clock_hz,
            current.run_scale,
            wanted.holding_torque_nm,
            wanted.rated_current_a,
            round(turn / full_step),
        )
        stealth = StealthSpace(device, axis, stealthchop_of(device), found.held, motor)
    except WrongState as error:
        say(str(error))
        return looked
    limits = device.axes[axis].settings.limits
    fastest, hardest = found.space.allowed(SPEED), found.space.allowed(ACCELERATION)
    if fastest < 0.999 * wanted.velocity_max_rps * turn:
        say(f"the soft limit of velocity is below {counted(wanted.velocity_max_rps, 'turn')} a second: ask for less")
    speed = min(wanted.velocity_max_rps * turn, fastest)
    acceleration = min(speed / SPEED_UP_S, hardest)
    length = math.ceil(speed**2 / acceleration + FAST_S * speed)
    turns = tuple(
        (rps, {SPEED: rps * turn, ACCELERATION: min(rps * turn / SPEED_UP_S, hardest)})
        for rps in TUNING_RPS
        if rps * turn <= speed
    )
    ground = Ground(
        found.space,
        current,
        stealth,
        state.position,
        full_step,
        turn,
        speed / turn,
        {SPEED: speed, ACCELERATION: acceleration},
        length,
        turns if stealth.tuned and stealth.for_tuning(stealth.frequency) else (),
    )
    far = state.position + _longest(ground)
    if limits.beyond(far):
        say(f"it would turn to {far}, and the soft limits end before: begin elsewhere, or ask for less speed")
    if stealth.tuned and wanted.holding_torque_nm is None:
        looked.warnings.append("no holding torque is told: PWM_GRAD is not calculated, only tuned by the chip")
    if not stealth.tuned:
        looked.warnings.append("this chip's amplitude has no parts that are set: only the switch-over speed is found")
    if not stealth.regulates(stealth.frequency):
        looked.warnings.append(
            "the current is too small to be regulated (t_blank f_PWM V / R): its amplitudes are tuned with a shorter "
            "blank time (TBL) or a slower PWM, and nothing corrects them afterwards"
            if ground.turns
            else "the current is too small to be regulated (t_blank f_PWM V / R): nothing tunes or checks the "
            "amplitudes, so the calculated ones are taken; a lower supply would help"
        )
    looked.warnings += [*room_told(limits), *stealth.unfit]
    looked.ground = ground
    return looked


def _longest(ground: Ground) -> int:
    return max(ground.length, *(ground.tuning_way for _ in ground.turns[:1]), 4 * ground.full_step)


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(QuietStealthChop)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, axis, wanted)
        if told.time_s > document.budget.time_s:
            told.warnings.append(f"its time of {plain(document.budget.time_s)} s may end before the proof")

    return await planned("StealthChop", look(device, axis, wanted), tell)


def _tell(told: StudyPlan, ground: Ground, axis: int, wanted: QuietStealthChop) -> None:
    needed = ground.needed_rps if ground.turns else []
    tunings = len(ground.turns) + TUNING_RUNS if ground.turns else 0
    rounds = PLACES * (1 + len(ground.switches_rps) + 6) + 2 * wanted.pairs
    told.position_from, told.position_to = ground.start, ground.start + _longest(ground) + ground.full_step
    told.velocity_max_pps, told.acceleration_max_pps2 = ground.through[SPEED], ground.through[ACCELERATION]
    told.moves_max = 3 * rounds + 2 * (tunings + len(needed))
    tuning_way = tunings * ground.tuning_way + len(needed) * ground.needed_way
    told.way_fullsteps = 2 * (rounds * ground.length + tuning_way) / ground.full_step
    turning_s = 2 * (TUNING_TURNS / ground.turns[0][0] + SPEED_UP_S) if ground.turns else 0.0
    told.time_s = rounds * ground.round_s + tunings * turning_s
    told.time_s += sum(2 * (NEEDED_TURNS / rps + SPEED_UP_S) for rps in needed)
    told.registers = [f"{name} of axis {axis}" for name in ground.before]
    top = counted(ground.top_rps, "turn", 3)
    tuned = [
        "the chip tunes itself at rest and in turns at constant speed: PWM_OFS_AUTO and PWM_GRAD_AUTO are read",
        "in the same turns: the amplitude that its regulation needs at each speed",
        "each run begins afresh with the amplitudes as they are set: what its regulation adds is read under way",
    ]
    first = (
        f"runs there and back at up to {top} a second, set as now, from {PLACES} places of a full step: how the "
        "shaft jolts as the choppers change"
    )
    rising = (
        f"switch-over speeds from {plain(LEAST_RPS)} turns a second on, each {100 * (TIMES - 1):.0f} % over the one "
        f"before, until the jolt exceeds {plain(wanted.jolt_max_fullsteps)} full steps or the voltage ends"
    )
    told.steps = [
        first,
        *(tuned if ground.turns else []),
        rising,
        *(
            ["what it needs up to that speed against what the chip has tuned, and what is calculated from the motor"]
            if ground.turns
            else []
        ),
        f"{wanted.pairs} times the same with the setting before and with the best one, in turn",
        "the best one stays where it is shown to be better, else the old one goes back"
        if wanted.keep
        else "the old setting goes back, whatever came of it; one click takes the new one",
    ]
    told.unwatched = [
        "noise that is heard: a motor is quiet with StealthChop, and the study finds how far it can go with it",
        "what the axis has to hold at rest: half the run current is set there between runs, if it is more now",
        "another load, another acceleration: the jolt is that of these runs",
        "current itself: the wire tells the amplitude of the voltage, and what its regulation adds",
    ]
