"""What a study of the chopper will do, and what is missing before it can."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ...devices.core.capabilities import EncoderSetting
from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import counted, plain
from ..current_settings import CurrentSpace
from ..document import CalmChopper, StudyDocument
from ..encoder_scale import microsteps_a_count
from ..families import chopper_of, current_of, identification_of
from ..plan import Looked, StudyPlan, axis_now, planned, room_told
from ..ramp_settings import ACCELERATION, SPEED, RampSpace
from .setting import ChopperSetting, ChopperSpace, Coil

SPEED_UP_S = 0.2
"""How long these runs speed up and brake [s]."""
SETTLES_S = 0.6
"""What a shaft takes at a constant speed until it shakes as much as it ever will [s]: a resonance builds up, and how
far it has come before that is luck."""
RUN_S = 0.4
"""What counts of a run, at constant speed [s]."""
LEAST_PERIODS = 8
"""Electrical periods that count at the least."""
AROUND_S = 0.45
"""What a run takes beside its way [s]."""
FINALISTS, AGAIN = 3, 2
BASELINE_ROUNDS = 2


@dataclass(frozen=True, slots=True)
class Cruise:
    """A run at one speed [microsteps, pps]: `lead` to speed up and settle, `way` that counts, `tail` to brake."""

    rps: float
    ramp: dict[str, float]
    lead: int
    way: int
    tail: int

    @property
    def length(self) -> int:
        return self.lead + self.way + self.tail

    @property
    def time_s(self) -> float:
        """Of one run, there or back [s]."""
        return self.length / self.ramp[SPEED] + SPEED_UP_S + AROUND_S


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. start, full_step : [microsteps]; least : what the encoder shows of rest
    at most, rounding to its counts [full steps]."""

    ramp: RampSpace
    chopper: ChopperSpace
    allowed: Sequence[ChopperSetting]
    cruises: Sequence[Cruise]
    start: int
    full_step: int
    least: float

    @property
    def before(self) -> list[str]:
        return [each.name for each in (*self.ramp.before, *self.chopper.before)]

    @property
    def round_s(self) -> float:
        """There and back at each speed [s]."""
        return 2 * sum(each.time_s for each in self.cruises)


async def look(device: Device, axis: int, wanted: CalmChopper) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    found = await axis_now(device, axis, looked.missing)
    if found is None:
        return looked
    try:
        device.need(EncoderSetting).require_encoder(axis)
        scales = CurrentSpace(device, axis, current_of(device), found.held)
        coil = Coil(
            wanted.resistance_ohm,
            wanted.inductance_h,
            wanted.run_current_a,
            wanted.supply_v,
            device.session.clock_hz,
            scales.run_scale,
        )
        chopper = ChopperSpace(device, axis, chopper_of(device), found.held, coil)
    except WrongState as error:
        say(str(error))
        return looked
    state, full_step = found.state, found.full_step
    if state.encoder_position is None:
        say("no encoder tells its position: nothing else sees the shaft shake, so ripple cannot be measured")
    allowed = chopper.allowed(wanted.lowest_hz)
    if not allowed:
        say(
            f"no setting chops at {plain(wanted.lowest_hz / 1e3)} to 60 kHz with these figures of coil, current and "
            "supply: look at them, or allow a lower frequency"
        )
        return looked
    limits = device.axes[axis].settings.limits
    most = found.space.allowed(SPEED), found.space.allowed(ACCELERATION)
    cruises = [_cruise(rps, found.turn, full_step, most) for rps in wanted.speeds_rps]
    if any(each.ramp[SPEED] < 0.999 * each.rps * found.turn for each in cruises):
        say(f"the soft limit of velocity is below {counted(max(wanted.speeds_rps), 'turn')} a second: take slower ones")
    longest = max(each.length for each in cruises)
    if limits.beyond(state.position + longest):
        say(f"it would turn to {state.position + longest}, and the soft limits end before: begin elsewhere")
    looked.warnings += [*room_told(limits), *chopper.unfit]
    a_count = microsteps_a_count(device, axis, identification_of(device).encoder, found.held)
    if a_count is None:
        looked.warnings.append(
            "how fine its encoder is is not known: one of less than some 10,000 counts a turn shows no chopper, and "
            "then nothing will be shown to be calmer"
        )
        a_count = full_step / 100
    least = a_count / math.sqrt(12) / full_step
    looked.ground = Ground(found.space, chopper, allowed, cruises, state.position, full_step, least)
    return looked


def _cruise(rps: float, turn: int, full_step: int, most: tuple[float, float]) -> Cruise:
    speed = min(rps * turn, most[0])
    acceleration = min(speed / SPEED_UP_S, most[1])
    tail = math.ceil(speed**2 / (2 * acceleration)) + 4 * full_step
    lead = tail + round(SETTLES_S * speed)
    way = max(round(RUN_S * speed), LEAST_PERIODS * 4 * full_step)
    return Cruise(rps, {SPEED: speed, ACCELERATION: acceleration}, lead, way, tail)


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(CalmChopper)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, axis, wanted, document.budget.trials)
        if told.time_s > document.budget.time_s:
            told.warnings.append(f"its time of {plain(document.budget.time_s)} s may end before the proof")

    return await planned("Chopper", look(device, axis, wanted), tell)


def _tell(told: StudyPlan, ground: Ground, axis: int, wanted: CalmChopper, trials: int) -> None:
    rounds = BASELINE_ROUNDS + trials + FINALISTS * AGAIN + 2 * wanted.pairs
    lengths = [each.length for each in ground.cruises]
    told.position_from, told.position_to = ground.start, ground.start + max(lengths)
    told.velocity_max_pps = max(each.ramp[SPEED] for each in ground.cruises)
    told.acceleration_max_pps2 = max(each.ramp[ACCELERATION] for each in ground.cruises)
    told.moves_max = 2 * len(ground.cruises) * rounds
    told.way_fullsteps = 2 * rounds * sum(lengths) / ground.full_step
    told.time_s = rounds * ground.round_s
    told.registers = [f"{name} of axis {axis}" for name in ground.before]
    speeds, tried = counted(wanted.speeds_rps, "turn"), counted(trials, "setting")
    told.steps = [
        f"runs there and back at {speeds} a second, with SpreadCycle as it is set: how much the shaft shakes",
        f"the same with what is calculated from the coil: {ground.chopper.calculated.words}",
        f"the same with what a search asks for: {tried} at most, of {len(ground.allowed)} that may be tried",
        f"{wanted.pairs} times the same with the setting before and with the best one, in turn",
        "the best one stays where it is shown to be calmer, else the old one goes back"
        if wanted.keep
        else "the old setting goes back, whatever came of it; one click takes the new one",
    ]
    told.unwatched = [
        "noise that is heard and no shaft shows; the chopper's frequency is an estimate from what was told of the coil",
        "how warm driver and motor become: ripple and a fast chopper heat both",
        "StealthChop is off meanwhile: this is about SpreadCycle",
    ]
