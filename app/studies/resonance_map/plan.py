"""What a resonance map will do, and what is missing before it can."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import counted, plain, times
from ...profiles.capture import CapturedConfiguration
from ..current_settings import CurrentSpace
from ..document import ResonanceMap, StudyDocument
from ..families import CURRENTS, current_of, ripple_of
from ..field_settings import FieldSpace, place_of, word_before
from ..plan import Looked, StudyPlan, axis_that_sees_lost_steps, planned, room_told
from ..ramp_settings import ACCELERATION, JERK, SPEED, RampSpace
from ..record import Held

SETTLE_S = 0.3
"""A speed is held so long before its ripple counts: what the ramp has set ringing is over."""
CRUISE_S, CRUISE_TURNS = 1.0, 0.5
"""So long, and so far, a speed is looked at: the longer of both, as far as the travel goes."""
LEAST_TURNS = 0.5
AROUND_S = 0.35
"""What a way takes beside its ramps: coming to rest, and looking [s]."""
FINER = (0.8, 0.87, 0.93, 0.97, 1.03, 1.07, 1.15, 1.25)
"""Speeds around one at which an order meets the resonance, as shares of it."""
FINER_ORDERS = 2
COMPARED_EVERY = 2
"""Every so many of the first speeds is compared with each change, and each named one."""
CROSSINGS = 3
SCALE, QUIET = "run current scale", "StealthChop"


@dataclass(frozen=True, slots=True)
class Setting:
    """A change that is compared with how the axis is set. figures, before : with it and without"""

    name: str
    figures: dict[str, float]
    before: dict[str, float]
    units: dict[str, str]
    registers: list[Held]


@dataclass(frozen=True, slots=True)
class Ground:
    """What is known before the first move. start, full_step, turn, travel : [microsteps]; ramp : as it is set [pps,
    pps^2, pps^3]; before : what goes back."""

    space: RampSpace
    start: int
    full_step: int
    turn: int
    travel: int
    ramp: dict[str, float]
    speeds: list[float]
    settings: list[Setting] = field(default_factory=list)
    before: list[Held] = field(default_factory=list)

    @property
    def periods(self) -> float:
        """Electrical periods of a turn."""
        return self.turn / (4 * self.full_step)

    def ramp_s(self, speed_rps: float) -> float:
        """What it takes to come up to a speed [s]."""
        speed, jerk = speed_rps * self.turn, self.ramp.get(JERK)
        return speed / self.ramp[ACCELERATION] + (self.ramp[ACCELERATION] / jerk if jerk else 0.0)

    def lead(self, speed_rps: float) -> float:
        """Before a speed counts, and behind it [microsteps]."""
        return speed_rps * self.turn * (self.ramp_s(speed_rps) / 2 + SETTLE_S)

    def cruise(self, speed_rps: float) -> float:
        """How far a speed is looked at [microsteps]; less than half a turn: there is no room for it."""
        wanted = max(CRUISE_TURNS, speed_rps * CRUISE_S) * self.turn
        return min(wanted, self.travel - 2 * self.lead(speed_rps))

    def way_s(self, speed_rps: float) -> float:
        """One way at a speed takes about so long [s]."""
        way = self.cruise(speed_rps) + 2 * self.lead(speed_rps)
        return way / (speed_rps * self.turn) + self.ramp_s(speed_rps) + AROUND_S

    def has_room(self, speed_rps: float) -> bool:
        """Whether the travel is enough for a speed."""
        return self.cruise(speed_rps) >= LEAST_TURNS * self.turn


async def look(device: Device, axis: int, wanted: ResonanceMap) -> Looked[Ground]:
    """What there is and what is missing. Nothing moves. Raises BenchError where the device does not answer."""
    looked = Looked[Ground]()
    say = looked.missing.append
    found = await axis_that_sees_lost_steps(device, axis, looked.missing, "nothing else sees the rotor vibrate")
    if found is None:
        return looked
    space, state, limits = found.space, found.state, device.axes[axis].settings.limits
    now = space.now()
    if not all(now.values()):
        say("its speed or acceleration is 0: set a ramp at which it moves, for a start")
        return looked
    travel = round(wanted.travel_turns * found.turn)
    if limits.beyond(state.position + travel):
        say(
            f"it would go to {state.position + travel}, and the soft limits end before: begin elsewhere, or less travel"
        )
    looked.warnings += room_told(limits)
    fastest = min(
        wanted.velocity_max_rps,
        space.allowed(SPEED) / found.turn,
        device.motion.speed_limit_pps(axis) / found.turn,
    )
    acceleration = min(now[ACCELERATION], limits.acceleration_max_pps2 or math.inf)
    ground = Ground(
        space,
        state.position,
        found.full_step,
        found.turn,
        travel,
        {**now, ACCELERATION: acceleration},
        [],
        before=list(space.before),
    )
    asked = np.geomspace(wanted.velocity_min_rps, max(fastest, wanted.velocity_min_rps), wanted.speeds)
    ground.speeds.extend(float(speed) for speed in asked if ground.has_room(speed))
    if len(ground.speeds) < wanted.speeds or fastest < wanted.velocity_max_rps:
        last = ground.speeds[-1] if ground.speeds else 0.0
        looked.warnings.append(
            f"{counted(last, 'turn', 3)} a second is the fastest with this travel, acceleration and limits"
        )
    if len(ground.speeds) < wanted.speeds / 2:
        say("there is no room for half of the speeds: more travel, or a greater acceleration")
    try:
        ground.settings.extend(_settings(device, axis, wanted, found.held, ground.before))
    except WrongState as error:
        say(str(error))
        return looked
    if wanted.current_shares and not any(SCALE in one.figures for one in ground.settings):
        looked.warnings.append("no change of the current is compared: none that this chip can be set to")
    looked.ground = ground
    return looked


def _settings(
    device: Device, axis: int, wanted: ResonanceMap, held: CapturedConfiguration, before: list[Held]
) -> Sequence[Setting]:
    """The changes that this chip can be set to; what they set joins `before`. Raises WrongState."""
    told: list[Setting] = []
    if wanted.current_shares and device.family.family in CURRENTS:
        current = CurrentSpace(device, axis, current_of(device), held)
        before.extend(current.before)
        for share in wanted.current_shares:
            scale = round(share * (current.run_scale + 1)) - 1
            if not 0 <= scale < current.steps or scale == current.run_scale:
                continue
            name = f"{100 * current.share(scale):.0f} % of the current"
            registers = current.registers(scale, min(scale, current.hold_scale))
            told.append(
                Setting(name, {SCALE: scale}, {SCALE: current.run_scale}, {SCALE: f"1/{current.steps}"}, registers)
            )
    places = ripple_of(device)
    at = None if places is None else place_of(device, axis, places.quiet)
    if wanted.other_chopper and places is not None and at is not None and at[1] is not None:
        quiet = at[1].unpack(word_before(device, at[0], held))
        values = dict(places.spreadcycle if quiet else places.stealthchop)
        chopper = FieldSpace(device, axis, values, held)
        before.extend(chopper.before)
        name = "SpreadCycle" if quiet else "StealthChop"
        told.append(Setting(name, {QUIET: not quiet}, {QUIET: quiet}, {QUIET: "0/1"}, chopper.registers(values)))
    return told


async def plan(device: Device, axis: int, document: StudyDocument) -> StudyPlan:
    """What the study would do. Nothing moves."""
    wanted = document.wanted(ResonanceMap)

    def tell(told: StudyPlan, ground: Ground) -> None:
        _tell(told, ground, wanted)
        if told.time_s > document.budget.time_s:
            told.warnings.append(
                f"its time of {plain(document.budget.time_s)} s ends before the last change is compared: it needs more"
            )

    return await planned("Resonance map", look(device, axis, wanted), tell)


def _tell(told: StudyPlan, ground: Ground, wanted: ResonanceMap) -> None:
    if not ground.speeds:
        return
    compared = ground.speeds[::COMPARED_EVERY]
    mean_s = float(np.mean([ground.way_s(speed) for speed in ground.speeds]))
    mapped = len(ground.speeds) + FINER_ORDERS * len(FINER)
    beside = (len(compared) + CROSSINGS) * 2 * len(ground.settings)
    told.position_from, told.position_to = ground.start, ground.start + ground.travel
    told.velocity_max_pps, told.acceleration_max_pps2 = ground.speeds[-1] * ground.turn, ground.ramp[ACCELERATION]
    told.moves_max = 2 * wanted.repeats * (mapped + beside) + 2
    longest = max(ground.cruise(speed) + 2 * ground.lead(speed) for speed in ground.speeds)
    told.way_fullsteps = told.moves_max * longest / ground.full_step
    told.time_s = told.moves_max * mean_s
    told.registers = [each.name for each in ground.before]
    first, last = plain(ground.speeds[0], 3), plain(ground.speeds[-1], 3)
    told.steps = [
        f"there and back at {len(ground.speeds)} speeds from {first} to {last} turns/s, {times(wanted.repeats)} each",
        "more speeds around those at which the ripple of an order grows",
        *(
            f"with {one.name} and without, in turn, at {len(compared)} of these speeds and at the resonances"
            for one in ground.settings
        ),
        "the setting as it is now goes back; one click takes a change that is shown to be quieter",
    ]
    told.unwatched = [
        "at a resonance it may lose steps: they are seen, the position is taken from the encoder, and it goes on",
        "what swings behind a soft coupling or a belt shows only as far as it moves the rotor",
        "less current has less torque: how little is enough, least current tells",
    ]
