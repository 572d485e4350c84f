"""What a microstep calibration will do, and what is missing before it can."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ...calc.microsteps.angle_correction import lengths
from ...calc.microsteps.mslut import decode
from ...devices.core.capabilities import EncoderSetting, MslutTable
from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import plain
from ..document import MicrostepCalibration, StudyDocument
from ..plan import Looked, StudyPlan, axis_now, planned, room_told
from ..ramp_settings import ACCELERATION, SPEED, RampSpace
from ..table_settings import TableSpace

SPEED_UP_S = 0.25
"""How long these moves speed up and brake [s]."""
FIRST_SPEEDS = (1.0, 0.5)
"""There and back at these shares of the speed, before any table is written: the error may not depend on it."""
AROUND_S = 0.5
"""What a run takes beside its way [s]."""


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move [microsteps]. ramp : [pps, pps^2]; lead : before and behind what counts."""

    space: RampSpace
    table: TableSpace
    start: int
    full_step: int
    turn: int
    lead: int
    way: int
    ramp: dict[str, float]

    @property
    def period(self) -> int:
        """An electrical period."""
        return 4 * self.full_step


async def look(device: Device, axis: int, wanted: MicrostepCalibration) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    found = await axis_now(device, axis, looked.missing)
    if found is None:
        return looked
    space, state, turn, full_step = found.space, found.state, found.turn, found.full_step
    try:
        device.need(EncoderSetting).require_encoder(axis)
        device.need(MslutTable)
        table = TableSpace(device, axis, found.held)
    except WrongState as error:
        say(str(error))
        return looked
    if state.encoder_position is None:
        say("no encoder tells its position: nothing else sees the angle error")
    if lengths(decode(table.now)).min() < 1:
        say("its table has a place without current: write a sine first (Microsteps)")
        return looked
    if table.shared:
        looked.warnings.append("both motors of this chip are turned by the one table that is written")
    limits = device.axes[axis].settings.limits
    speed = min(wanted.velocity_rps * turn, space.allowed(SPEED))
    acceleration = min(speed / SPEED_UP_S, space.allowed(ACCELERATION))
    # A new table holds from the next zero of the wave on, and counts from the first whole period at speed.
    period = 4 * full_step
    lead = period * math.ceil(1 + speed**2 / (2 * acceleration) / period)
    way = wanted.turns * turn + 2 * lead
    if limits.beyond(state.position + way):
        say(f"it would turn to {state.position + way}, and the soft limits end before: begin elsewhere")
    looked.warnings += room_told(limits)
    ramp = {SPEED: speed, ACCELERATION: acceleration}
    looked.ground = Ground(space, table, state.position, full_step, turn, lead, way, ramp)
    return looked


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(MicrostepCalibration)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, axis, wanted)
        if told.time_s > document.budget.time_s:
            told.warnings.append(f"its time of {plain(document.budget.time_s)} s ends before the proof: it needs more")

    return await planned("Microstep calibration", look(device, axis, wanted), tell)


def _tell(told: StudyPlan, ground: Ground, axis: int, wanted: MicrostepCalibration) -> None:
    told.position_from, told.position_to = ground.start, ground.start + ground.way
    told.velocity_max_pps, told.acceleration_max_pps2 = ground.ramp[SPEED], ground.ramp[ACCELERATION]
    told.moves_max = 2 * len(FIRST_SPEEDS) + 4 * wanted.pairs
    told.way_fullsteps = told.moves_max * ground.way / ground.full_step
    ways = 2 * sum(1 / share for share in FIRST_SPEEDS) + 4 * wanted.pairs
    told.time_s = ways * ground.way / ground.ramp[SPEED] + told.moves_max * (SPEED_UP_S + AROUND_S)
    told.registers = [f"{each.name} of axis {axis}" for each in ground.space.before]
    told.registers.append(f"the microstep table of {'both axes' if ground.table.shared else f'axis {axis}'} (MSLUT)")
    turns = "a turn" if wanted.turns == 1 else f"{wanted.turns} turns"
    told.steps = [
        f"{turns} there and back at {plain(wanted.velocity_rps)} turns a second, and at half of that: the angle error",
        "a table is worked out, and what it will leave; where that is no gain, it ends here",
        f"{wanted.pairs} times {turns} there and back with the old table and with the new one, in turn",
        "the new table stays where it is shown to be better, else the old one goes back"
        if wanted.keep
        else "the old table goes back, whatever came of it; one click takes the new one",
    ]
    told.unwatched = [
        "what the encoder itself is off once, twice or four times an electrical period looks like the motor's",
        "the error under another load or current: friction and detent have another share there",
    ]
