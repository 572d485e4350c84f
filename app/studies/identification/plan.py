"""What an identification will do, and what is missing before it can."""

from __future__ import annotations

from dataclasses import dataclass

from ...devices.core.capabilities import EncoderSetting
from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import counted, plain
from ..current_settings import CurrentSpace
from ..document import Identification, StudyDocument
from ..encoder_scale import microsteps_a_count
from ..families import current_of, identification_of
from ..field_settings import FieldSpace
from ..plan import AxisNow, Looked, StudyPlan, axis_now, planned, room_told
from ..ramp_settings import ACCELERATION, SPEED, RampSpace
from ..ringing import HOP_PPS, HOPS, RING_S
from .coil import SPEED_UP_S, SPEEDS_RPS, TUNES_WITHIN_S, AmplitudePlaces, CoilTold

TURN_S = 0.5
"""What a slow turn takes beside its way [s]."""
LEAST_SCALE = 3


@dataclass(frozen=True, slots=True)
class AmplitudeGround:
    """For resistance and back-EMF. ramps : each at one speed [turns of the motor a second]; fields : what is set."""

    places: AmplitudePlaces
    fields: FieldSpace
    ramps: RampSpace
    speeds: tuple[tuple[float, dict[str, float]], ...]
    told: CoilTold


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move [microsteps]. low_scale : current scale of the turns with less current;
    a_count : what a count of the encoder is set to be; lead : before and behind a turn; hop_pps : [pps]; amplitude :
    None where no resistance can be told, `no_amplitude` says why then."""

    ramp: RampSpace
    current: CurrentSpace
    low_scale: int
    a_count: float | None
    start: int
    full_step: int
    turn: int
    lead: int
    slow_pps: float
    hop_pps: float
    amplitude: AmplitudeGround | None
    no_amplitude: str

    @property
    def turns(self) -> tuple[tuple[int, float], ...]:
        """Current scale, and times the slow speed, of each slow turn: twice the speed tells what of it is the speed's,
        less current what is friction. Not both at once, which would be nearer to its resonance."""
        return (self.current.run_scale, 1.0), (self.current.run_scale, 2.0), (self.low_scale, 1.0)

    @property
    def way(self) -> int:
        """Of a slow turn, there or back."""
        return self.turn + 2 * self.lead

    @property
    def most(self) -> float:
        """The greatest acceleration that may be set [pps^2]."""
        return self.ramp.most(ACCELERATION)


async def look(device: Device, axis: int, wanted: Identification) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    found = await axis_now(device, axis, looked.missing)
    if found is None:
        return looked
    state, turn, full_step = found.state, found.turn, found.full_step
    try:
        device.need(EncoderSetting).require_encoder(axis)
        places = identification_of(device)
        ramp = RampSpace(device, axis, places.hop, found.held)
        current = CurrentSpace(device, axis, current_of(device), found.held)
    except WrongState as error:
        say(str(error))
        return looked
    if state.encoder_position is None:
        say("no encoder tells its position: nothing else sees the rotor ring")
    low = round(wanted.current_share * (current.run_scale + 1)) - 1
    if low < LEAST_SCALE:
        say(f"the run current is set to scale {current.run_scale} of {current.steps - 1}: too little to tell by")
    limits = device.axes[axis].settings.limits
    lead = 4 * full_step
    if limits.beyond(state.position + turn + 2 * lead):
        say(f"it would turn to {state.position + turn + 2 * lead}, and the soft limits end before: begin elsewhere")
    looked.warnings += room_told(limits)
    hop = min(HOP_PPS, ramp.allowed(SPEED))
    if hop < HOP_PPS:
        looked.warnings.append(
            f"a hop is made at {plain(hop, 4)} pps, as its ramp and soft limits allow: a fast resonance may not show"
        )
    slow = min(wanted.velocity_rps * turn, hop)
    if limits.acceleration_max_pps2 is not None:
        looked.warnings.append(
            "a hop starts and stops at its full speed: the soft limit of acceleration bounds no jump"
        )
    scale = microsteps_a_count(device, axis, places.encoder, found.held)
    amplitude, why = _amplitude(device, axis, found, wanted)
    looked.ground = Ground(ramp, current, low, scale, state.position, full_step, turn, lead, slow, hop, amplitude, why)
    return looked


def _amplitude(device: Device, axis: int, found: AxisNow, wanted: Identification) -> tuple[AmplitudeGround | None, str]:
    """What resistance and back-EMF are told by, or why they are not."""
    places, find = identification_of(device).amplitude, device.family.table.find
    if wanted.supply_v is None or wanted.run_current_a is None:
        return None, "supply and run current are not told"
    if places is None or find(places.at_rest, axis) is None or find(places.now, axis) is None:
        return None, f"a {device.model.upper()} does not tell the amplitude that its StealthChop has tuned"
    try:
        fields = FieldSpace(device, axis, places.every, found.held)
    except WrongState as error:
        return None, str(error)
    fastest, hardest = found.space.allowed(SPEED) / found.turn, found.space.allowed(ACCELERATION)
    speeds = tuple(
        (rps, {SPEED: rps * found.turn, ACCELERATION: min(rps * found.turn / SPEED_UP_S, hardest)})
        for rps in SPEEDS_RPS
        if rps <= fastest
    )
    told = CoilTold(wanted.run_current_a, wanted.supply_v)
    return AmplitudeGround(places, fields, found.space, speeds, told), ""


def hop_targets(ground: Ground, count: int) -> list[int]:
    """Where the hops go: the first half of them to positions above, the others back [microsteps]."""
    places = [ground.start + ground.lead]
    for index in range(count):
        step = round(HOPS[index % len(HOPS)] * ground.full_step)
        places.append(places[-1] + (step if index < count // 2 else -step))
    return places


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(Identification)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, axis, wanted)

    return await planned("Motor and machine", look(device, axis, wanted), tell)


def _tell(told: StudyPlan, ground: Ground, axis: int, wanted: Identification) -> None:
    places = hop_targets(ground, wanted.hops)
    told.position_from = min(ground.start, *places)
    told.position_to = max(ground.start + ground.way, *places)
    told.velocity_max_pps, told.acceleration_max_pps2 = ground.hop_pps, ground.most
    told.moves_max = 2 * len(ground.turns) + wanted.hops + 2
    told.way_fullsteps = (
        2 * len(ground.turns) * ground.way + max(places) - min(places) + 2 * ground.lead
    ) / ground.full_step
    slow_s = 2 * sum(ground.way / ground.slow_pps / times + TURN_S for _, times in ground.turns)
    told.time_s = slow_s + wanted.hops * (RING_S + 0.1)
    told.registers = [f"{each.name} of axis {axis}" for each in (*ground.ramp.before, *ground.current.before)]
    told.unwatched = [
        "whether the play is in the coupling of the encoder or in what moves the load, one encoder cannot tell",
        "rotor and load swing as one: a load on a soft coupling rings at a frequency of its own",
    ]
    told.steps = [
        f"a turn there and back at {plain(wanted.velocity_rps)} turns a second and at twice that, with the run current",
        f"the first with {100 * ground.current.share(ground.low_scale):.0f} % of it: friction grows, backlash does not",
        f"{wanted.hops} hops of about three quarters of a full step, after each of which the rotor rings out",
        *_amplitude_told(told, ground, axis),
        "the setting as it is now goes back: nothing of it is changed",
    ]


def _amplitude_told(told: StudyPlan, ground: Ground, axis: int) -> list[str]:
    """The steps of resistance and back-EMF; what they cost joins what is told."""
    amplitude = ground.amplitude
    if amplitude is None:
        told.unwatched.append(f"resistance and back-EMF: {ground.no_amplitude}")
        return []
    told.registers += [f"{each.name} of axis {axis}" for each in amplitude.fields.before]
    told.time_s += TUNES_WITHIN_S
    steps = ["at rest StealthChop tunes itself: the amplitude of its PWM tells the resistance"]
    if not amplitude.speeds:
        return steps
    fastest = amplitude.speeds[-1]
    turns = [ramp[SPEED] for _, ramp in (*amplitude.speeds, fastest)]  # the last with less current, too
    told.moves_max += 2 * len(turns)
    told.way_fullsteps += 2 * len(turns) * ground.way / ground.full_step
    told.time_s += sum(2 * (ground.way / speed + TURN_S) for speed in turns)
    told.velocity_max_pps = max(ground.hop_pps, fastest[1][SPEED])
    share = f"{100 * ground.current.share(ground.low_scale):.0f} %"
    steps.append(
        f"turns there and back with StealthChop, at {counted(fastest[0], 'turn')} a second at most, the last with "
        f"{share} of the current, or with more where so little is not measured: inductance and back-EMF"
    )
    return steps
