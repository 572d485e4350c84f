"""The first look itself: a slow turn there and back, and, where it may, the way to the switches."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict

import numpy as np

from ...calc.positions.encoder_resolution import SLACK_MICROSTEPS, measured_encoder
from ...devices.core.capabilities import EncoderIndex, EncoderSetting
from ...devices.core.results import AxisState
from ...devices.core.signs import EncoderSeen
from ...number_text import plain
from ...procedures.procedure import Failed
from ..document import FirstLook
from ..driver_faults import state_now
from ..moves import PERIOD_FULLSTEPS
from ..parts import Interval
from ..ramp_settings import ACCELERATION, SPEED, UNITS
from ..record import Finding, Held, Mend
from ..run import StudyRun
from ..sampled import sampling
from ..until_switch import Side, SwitchMet, go_until_switch
from .encoder_fit import EncoderFit, fit_encoder
from .encoder_index import IndexMet, index_findings
from .faults import STANDS, SWITCH_PLAY_FULLSTEPS, TO_DO, Named, Way, of_turns, open_phase, pulled
from .found import look_found
from .plan import CREEP_FULLSTEPS, EDGE_FULLSTEPS, Ground, look, travel_of

RATE_HZ = 250.0
POLL_S = 0.02
LONGEST = 3.0
REST_S = 0.2
STARTS_S = 5.0
"""What a move may take beside its way [s]."""
RIGHT = 0.01
"""A ratio this near to 1 is right: slips and wrong resolutions are farther off."""


class FirstLookStudy(StudyRun):
    """Tells what an axis is: findings with how sure they are, and the registers that would set it right."""

    _ground: Ground
    _looks: list[dict[str, bool]]
    """Flags of the driver, of each look under way."""
    _loads: list[float]
    _latched: list[int] | None
    """Where the encoder was as its index was met on the way under way [microsteps]; None: it is not looked for."""
    _ways_met: list[IndexMet]
    _stays: bool
    """Whether the motor had better not be moved on."""

    @property
    def wanted(self) -> FirstLook:
        return self.record.document.wanted(FirstLook)

    async def _study(self) -> None:
        record, wanted = self.record, self.wanted
        self.tell("preconditions", 0.0, "looking at the axis")
        ground = self._ground = (await look(self.device, self.axis, wanted)).required()
        record.findings, record.looked = [], None
        self._stays = False
        self._looks, self._loads = list[dict[str, bool]](), list[float]()
        self._latched, self._ways_met = None, []
        if not record.baseline:
            record.baseline, record.baseline_setting = ground.before, ground.space.now()
        record.units = {name: UNITS[name] for name in ground.ramp}
        await self.keeper.save(record)
        await self.apply(self._registers(ground.ramp), "slow moves")
        await self._encoder()
        if self._stays:
            self._find("switches", "not looked for: the motor does not go where it is told", sure="cannot be told")
        elif wanted.travel_turns:
            await self._travel()
        else:
            self._find("switches", "not looked for: travel_turns is 0", sure="cannot be told")
        self._find("direction", self._direction(), sure="cannot be told")
        await self.back()
        wrong = [one for one in record.findings if one.remedy or one.fault or one.sure == "missing"]
        record.verdict = (
            f"{len(wrong)} to be set right: {', '.join(one.name for one in wrong)}" if wrong else "all is well"
        )
        record.next = "set these right, and look once more" if wrong else "fastest move"

    def _find(self, name: str, text: str, **more: object) -> None:
        self.record.findings.append(Finding.model_validate({"name": name, "text": text, **more}))

    def _direction(self) -> str:
        polarity = next((one.value for one in self.record.findings if one.name == "polarity"), None)
        known = ""
        if polarity is not None:
            known = f"as the position counter goes up, the encoder goes {'up' if polarity > 0 else 'down'}; "
        return (
            f"{known}which way of the machine that is (out, up, closing) only eyes can tell: where it is the wrong "
            "one, swap the two wires of one coil, or turn the motor round by its setting"
        )

    def _broken(self, named: Named) -> None:
        self._stays = self._stays or named.fault in ("open phase", "overload")
        self._find(named.fault, f"{named.text}: {TO_DO[named.fault]}", fault=named.fault, sure="measured")

    def _registers(self, ramp: dict[str, float]) -> list[Held]:
        """A ramp, and what is set of the encoder meanwhile."""
        return [*self._ground.space.registers(ramp), *self._ground.encoder.registers]

    @property
    def _full_step(self) -> int:
        return self._ground.turn // self.device.axes[self.axis].settings.full_steps_per_rev

    # --- the encoder --------------------------------------------------------------------------------

    async def _encoder(self) -> None:
        ground, wanted = self._ground, self.wanted
        if not ground.encoder.exists:
            text = "this chip reads none: a switch alone can tell of lost steps (fastest move)"
            self._find("encoder", text, sure="cannot be told")
            return
        if ground.encoder.untold:
            self._find("encoder", f"it cannot be looked for: {ground.encoder.untold}", sure="cannot be told")
            return
        self.tell("look", 0.1, "turning there")
        self.keeper.mark("turning there and back")
        far = ground.start + round(wanted.turns * ground.turn)
        ways: list[Way] = []
        for part, target in enumerate((far, ground.start, far, ground.start)):
            self.tell("look", 0.1 + 0.1 * part, "and back" if part % 2 else "turning there")
            fault = await self._way(ways, target)
            if fault is not None:
                if ground.encoder.provisional is None:
                    self._keep(ways, 1.0)
                self._broken(fault)
                return
        there, back = ways[:2]
        position = np.concatenate((there.position, back.position))
        encoder = np.concatenate((there.encoder, back.encoder))
        forward = np.arange(len(position)) < len(there.position)
        try:
            found = fit_encoder(position, encoder, forward, ground.turn)
        except ValueError as error:
            raise Failed(f"nothing to fit: {error}") from error
        self._keep(ways, 1 / found.ratio if abs(found.ratio) >= STANDS else 1.0)
        self._tell_encoder(found, await self._state(), far - ground.start)

    def _keep(self, ways: list[Way], scale: float) -> None:
        """Keep what the encoder told for the report; `scale` makes microsteps of the motor of it."""
        told = [(way.position, way.encoder) for way in ways]
        self.record.looked = look_found(told, scale, self._full_step)

    async def _way(self, ways: list[Way], target: int) -> Named | None:
        """One more way, and what is broken by all of them. Raises Failed where it ends elsewhere, nothing named."""
        way, failure = await self._sampled(target)
        if failure is not None:
            turned_by_load = pulled(way, self._full_step)
            if not turned_by_load and self._load() != 0:
                raise failure
            by = "its load turns the shaft" if turned_by_load else "its load value is 0"
            return Named("overload", f"{by}, and {failure}")
        ways.append(way)
        # Where nobody knows whether an encoder is there, one that stands still says nothing of the shaft.
        load = self._load() if self._ground.encoder.provisional is None else None
        return open_phase(self._looks) or of_turns(ways, self._full_step, load)

    def _tell_encoder(self, found: EncoderFit, state: AxisState, way: int) -> None:
        if abs(found.ratio) < STANDS:
            self._find("encoder", self._why_it_stands_still(), value=found.ratio, sure="missing")
            return
        right = self._tell_resolution(found, state, way)
        with_it = "with" if found.ratio > 0 else "against"
        self._find("polarity", f"it counts {with_it} the motor", value=math.copysign(1.0, found.ratio), sure="certain")
        # In microsteps of the motor, whatever a count is set to be.
        scale = 1.0 if right else 1 / found.ratio
        self._find(
            "play",
            "between both ways: friction, backlash before the encoder, and half a count",
            value=scale * found.play,
            unit="microsteps",
            interval=_scaled(scale, found.play_interval),
        )
        self._tell_eccentricity(found, abs(scale) * 360 / self._ground.turn)
        if untold := self._ground.encoder.index_untold:
            self._find("index", untold, sure="cannot be told")
        else:
            self.record.findings += index_findings(self._ways_met, self._ground.turn, self._full_step)

    def _why_it_stands_still(self) -> str:
        if self._ground.encoder.provisional is not None:
            return (
                "nothing answers while the motor is told to turn: none is connected, or the motor does not turn at all "
                "(driver off, no supply); without one a switch alone can tell of lost steps (fastest move)"
            )
        return (
            "it stands still while the motor is told to turn: not connected, not on this shaft, or the motor does "
            "not turn at all (driver off, no supply, an open phase)"
        )

    def _tell_resolution(self, found: EncoderFit, state: AxisState, way: int) -> bool:
        """Whether it is set right."""
        provisional, turn = self._ground.encoder.provisional, self._ground.turn
        if provisional is None and abs(found.ratio - 1) <= RIGHT:
            self._find(
                "encoder",
                "its resolution is set right: it tells the way that the motor goes",
                value=found.ratio,
                interval=_between(found.ratio_interval),
            )
            return True
        setting = self.device.part(EncoderSetting)
        seen = EncoderSeen(ratio=found.ratio, way=way, slack=SLACK_MICROSTEPS)
        remedies = () if setting is None else setting.encoder_remedies(self.axis, state, seen)
        label, remedy = "no setting that fits is known", None
        if remedies:
            label = remedies[0].label
            remedy = Mend.model_validate(asdict(remedies[0]))
        if provisional is None:
            self._find(
                "encoder",
                f"it tells {plain(found.ratio, 5)} of the way that the motor is told to go: {label}",
                value=found.ratio,
                interval=_between(found.ratio_interval),
                remedy=remedy,
            )
            return False
        measured = measured_encoder(found.ratio * way / turn * provisional, way, turn, SLACK_MICROSTEPS)
        counts, half = measured.counts, measured.uncertainty
        lines = f" ({counts // 4:,} lines)" if counts % 4 == 0 else ""
        about = "" if measured.usual else "about "
        self._find(
            "encoder",
            f"one answers, of {about}{counts:,} counts a turn{lines}, and nobody has set what they are: {label}",
            value=float(counts),
            unit="counts a turn",
            interval=_between((abs(measured.counts_per_turn) - half, abs(measured.counts_per_turn) + half)),
            remedy=remedy,
        )
        return False

    def _tell_eccentricity(self, found: EncoderFit, scale_deg: float) -> None:
        """scale_deg : of the shaft, for what the encoder tells [deg/microstep]"""
        if found.eccentricity is None:
            self._find("eccentricity", "less than a turn was looked at", sure="cannot be told")
            return
        assert found.eccentricity_interval is not None
        self._find(
            "eccentricity",
            "once a turn: of the encoder or its coupling, which a look from one side cannot tell apart",
            value=found.eccentricity * scale_deg,
            unit="deg of the shaft",
            interval=_scaled(scale_deg, found.eccentricity_interval),
        )

    async def _sampled(self, target: int) -> tuple[Way, Failed | None]:
        """A move, position and encoder on its way [microsteps], and why it ended elsewhere."""
        there = {channel.name for channel in self.device.telemetry.channels()}
        load = f"load_value.{self.axis}"
        names = [f"position.{self.axis}", f"encoder_position.{self.axis}", *([load] if load in there else [])]
        failure: Failed | None = None
        if not self._ground.encoder.index_untold:
            await self._met_index()  # before this way
            self._latched = []
        with sampling(self.device, names, RATE_HZ, self.clock) as samples:
            try:
                await self._go(target, samples.take)
            except Failed as error:
                if _between_switches(await self._state()):
                    raise  # nothing is wrong with motor or load, as far as that tells
                failure = error
        position, encoder, *loads = samples.all()[1].T
        self._loads += [float(value) for each in loads for value in each[np.isfinite(each)]]
        known = np.isfinite(position) & np.isfinite(encoder)
        way, latched, self._latched = Way(position[known], encoder[known]), self._latched, None
        if latched is not None and len(way.position):
            self._ways_met.append(IndexMet(way, latched))
        return way, failure

    async def _met_index(self) -> int | None:
        return await self.device.need(EncoderIndex).index_met(self.axis)

    def _load(self) -> float | None:
        return float(np.median(self._loads)) if self._loads else None

    # --- the switches -------------------------------------------------------------------------------

    async def _travel(self) -> None:
        low, high = travel_of(self.device, self.axis, self.wanted, self._ground)
        edges: dict[str, int] = {}
        ways: tuple[tuple[Side, int], ...] = ("left", low), ("right", high)
        for at, (side, end) in enumerate(ways):
            self.tell("look", 0.5 + 0.2 * at, f"looking for the {side} switch")
            self.keeper.mark(f"looking for the {side} switch")
            met = await self._met(side, end)
            if met is None:
                self._find(f"{side} switch", f"none until {end}", sure="missing")
            else:
                edges[side] = met.at
                swung = "" if met.seen else ": it stops the motor at once, and the rotor swings out of it again"
                self._find(f"{side} switch", f"active at {met.at}{swung}", value=float(met.at), unit="microsteps")
                await self._edge(side, low, high)
        if len(edges) == 2:
            turns = (edges["right"] - edges["left"]) / self._ground.turn
            self._find("travel", "from switch to switch", value=turns, unit="turns of the motor")
        self.tell("look", 0.9, "going back")
        await self._go(self._ground.start, lambda: None)

    async def _met(self, side: Side, end: int) -> SwitchMet | None:
        state = await self._state()
        if getattr(state.switches, side) is None:
            return None
        longest_s = abs(end - state.position) / self._ground.ramp[SPEED] * LONGEST + STARTS_S
        return await go_until_switch(self.device, self.axis, self.clock, side, end, pressed=True, longest_s=longest_s)

    async def _edge(self, side: Side, low: int, high: int) -> None:
        """Look at the edge of a switch from both sides, slowly."""
        ground, at = self._ground, (await self._state()).position
        far, over = (round(each * self._full_step) for each in (EDGE_FULLSTEPS, PERIOD_FULLSTEPS))
        creep = {SPEED: CREEP_FULLSTEPS * self._full_step, ACCELERATION: ground.ramp[ACCELERATION]}
        await self.apply(self._registers(creep), "slowly, at the edge of a switch")
        out, within = (at + far, at - over) if side == "left" else (at - far, at + over)
        out, within = (min(max(place, low), high) for place in (out, within))
        released = await self._creep(side, out, pressed=False)
        pressed = None if released is None else await self._creep(side, within, pressed=True)
        await self.apply(self._registers(ground.ramp), "slow moves")
        if released is None or pressed is None:
            where = "released" if released is None else "pressed again"
            text = f"the {side} switch is not {where} within {EDGE_FULLSTEPS:g} full steps"
            self._broken(Named("switch backlash", text))
            return
        # Each edge lies between two looks, however far apart these are: so much play there is at the least.
        outwards = 1 if side == "left" else -1
        play = outwards * (released.before - pressed.before) / self._full_step
        if play > SWITCH_PLAY_FULLSTEPS:
            text = f"the {side} switch is released {play:.2g} full steps from where it is pressed, or more"
            self._broken(Named("switch backlash", text))

    async def _creep(self, side: Side, target: int, *, pressed: bool) -> SwitchMet | None:
        """Between which places a switch is pressed or released on the way to `target`; None where it is not."""
        self.record.runs += 1
        longest_s = LONGEST * 2 * EDGE_FULLSTEPS / CREEP_FULLSTEPS
        return await go_until_switch(
            self.device, self.axis, self.clock, side, target, pressed=pressed, longest_s=longest_s
        )

    # --- moves ----------------------------------------------------------------------------------------

    async def _go(self, target: int, take: Callable[[], None]) -> None:
        state = await self._state()
        self.record.runs += 1
        full_step = self._ground.turn / self.device.axes[self.axis].settings.full_steps_per_rev
        self.record.way_fullsteps += abs(target - state.position) / full_step
        until_s = self.clock.now() + self._longest_s(abs(target - state.position))
        if state.position != target:
            await self.device.motion.move(self.axis, target)
        while True:
            await self.clock.sleep(POLL_S)
            take()
            state = await self._state()
            if self._latched is not None and (met := await self._met_index()) is not None:
                self._latched.append(met)
            if not state.moving and state.position == target:
                break
            if state.moving:
                self._looks.append(state.flags)
            # A motor that stands too early is looked at until its time is over: what pulls it on then names the fault.
            if not state.moving and self.clock.now() > until_s - self._longest_s(0):
                raise Failed(f"the motor stands at {state.position}, not {target}: {_why_it_stands(state)}")
            if self.clock.now() > until_s:
                raise Failed(f"the motor has not arrived at {target} within its time")
        await self.clock.sleep(REST_S)

    def _longest_s(self, way: float) -> float:
        scale = self.device.session.time_scale or 1.0
        return (way / self._ground.ramp["speed"] * LONGEST + STARTS_S) / min(scale, 1.0)

    async def _state(self) -> AxisState:
        return await state_now(self.device, self.axis, self.clock)


def _between(ends: tuple[float, float]) -> Interval:
    return Interval(low=ends[0], high=ends[1])


def _scaled(scale: float, ends: tuple[float, float]) -> Interval:
    low, high = sorted(scale * end for end in ends)
    return Interval(low=low, high=high)


def _between_switches(state: AxisState) -> bool:
    return bool(state.switches.left and state.switches.right)


def _why_it_stands(state: AxisState) -> str:
    if _between_switches(state):
        return (
            "both of its end switches read as pressed, and leave it no way: see how they are wired, and which level is "
            "the pressed one"
        )
    return "by a switch, or its ramp is 0"
