"""What the first look will do, and what is missing before it can."""

from __future__ import annotations

from dataclasses import dataclass

from ...devices.core.device import Device
from ...number_text import counted, plain
from ..document import FirstLook, StudyDocument
from ..plan import Looked, StudyPlan, axis_now, planned
from ..ramp_settings import ACCELERATION, SPEED, RampSpace
from ..record import Held
from .encoder_ground import EncoderGround, encoder_ground

SPEED_UP_S = 0.25
"""How long these moves speed up and brake [s]."""
CREEP_FULLSTEPS = 10.0
"""How fast the edge of a switch is looked at [full steps a second], so that a look is a fifth of one apart."""
EDGE_FULLSTEPS = 40.0
"""As far from where the motor came to rest in a switch as its edge is looked for."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. start, turn : [microsteps]; ramp : [pps, pps^2]."""

    space: RampSpace
    start: int
    turn: int
    ramp: dict[str, float]
    encoder: EncoderGround

    @property
    def before(self) -> list[Held]:
        """What goes back at the end."""
        return [*self.space.before, *self.encoder.before]


async def look(device: Device, axis: int, wanted: FirstLook) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    found = await axis_now(device, axis, looked.missing)
    if found is None:
        return looked
    space, state, turn = found.space, found.state, found.turn
    limits = device.axes[axis].settings.limits
    far = round(wanted.turns * turn)
    if limits.beyond(state.position + far):
        say(f"it would turn to {state.position + far}, and the soft limits end before: begin elsewhere")
    if not limits.ranged and wanted.travel_turns:
        looked.warnings.append("no soft limits of position are set: it looks for switches as far as it was told")
    speed = min(wanted.velocity_rps * turn, limits.velocity_max_pps or float("inf"), space.most(SPEED))
    acceleration = min(speed / SPEED_UP_S, limits.acceleration_max_pps2 or float("inf"), space.most(ACCELERATION))
    encoder = encoder_ground(device, axis, read=state.encoder_position is not None, turn=turn, held=found.held)
    looked.ground = Ground(space, state.position, turn, {SPEED: speed, ACCELERATION: acceleration}, encoder)
    return looked


def travel_of(device: Device, axis: int, wanted: FirstLook, ground: Ground) -> tuple[int, int]:
    """How far it looks for switches to the left and to the right, soft limits kept [microsteps]."""
    limits, far = device.axes[axis].settings.limits, round(wanted.travel_turns * ground.turn)
    low, high = ground.start - far, ground.start + far
    if limits.position_min is not None:
        low = max(low, limits.position_min)
    if limits.position_max is not None:
        high = min(high, limits.position_max)
    return low, high


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(FirstLook)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, device, axis, wanted)

    return await planned("First look", look(device, axis, wanted), tell)


def _tell(told: StudyPlan, ground: Ground, device: Device, axis: int, wanted: FirstLook) -> None:
    far = ground.start + round(wanted.turns * ground.turn)
    told.position_from, told.position_to = ground.start, far
    told.velocity_max_pps, told.acceleration_max_pps2 = ground.ramp[SPEED], ground.ramp[ACCELERATION]
    told.moves_max, ways, edges_s = 4, 4 * abs(far - ground.start), 0.0
    told.steps = [
        f"twice {counted(wanted.turns, 'turn')} there and back at {counted(wanted.velocity_rps, 'turn')} a second",
        "no further where the motor does not go where it is told",
    ]
    if (provisional := ground.encoder.provisional) is not None:
        told.steps.insert(0, f"an encoder is looked for: {provisional:,} counts a turn are set meanwhile")
    if wanted.travel_turns:
        low, high = travel_of(device, axis, wanted, ground)
        told.position_from, told.position_to = min(low, ground.start), max(high, far)
        told.steps.append(
            f"slowly to the left until a switch, {low} at most, then to the right, {high} at most, and back"
        )
        told.steps.append(f"out of each switch and in again, {plain(EDGE_FULLSTEPS)} full steps at most")
        told.moves_max, ways, edges_s = 11, ways + 2 * (high - low), 4 * EDGE_FULLSTEPS / CREEP_FULLSTEPS
    told.steps.append("the setting as it is now goes back")
    told.way_fullsteps = ways / (ground.turn / device.axes[axis].settings.full_steps_per_rev)
    told.time_s = ways / ground.ramp[SPEED] + told.moves_max * (SPEED_UP_S + 0.3) + edges_s
    told.registers = [f"{each.name} of axis {axis}" for each in ground.before]
    told.unwatched = [
        "where a hard stop is, nothing tells: leave the travel out, or set soft limits, where one is near"
    ]
