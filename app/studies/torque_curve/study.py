"""The study itself: what the motor has at each speed, and what the ramp that is set leaves of it."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from ...number_text import plain
from ...procedures.procedure import Failed
from ..document import TorqueCurve
from ..leave_switch import leave_switch
from ..parts import Interval
from ..ramp_settings import ACCELERATION, SPEED
from ..record import Finding
from ..run import StudyRun
from ..switch_edge import SWITCHES
from .found import RampMargin, TorqueFound, TorquePoint
from .plan import LOW_RPS, Ground, look
from .ramps import Ramps
from .slips import Slips

GENTLY, TOP = 0.15, 0.25
"""Shares of what the motor has at the first speed: to come up to a speed, and to find the greatest one."""
BELOW_TOP = 0.9
"""The last speed, as a share of the greatest one."""
SWING = 1 / 0.725
"""A rotor without damping slips at this share of the static torque when an acceleration sets in at once."""


class Accelerated(Protocol):
    """How it is seen what the motor has: by slips that an encoder shows, or by a switch that tells of lost steps.

    All but `gently` and `lowest_rps` move the axis, and raise Failed, BenchError.
    """

    def lowest_rps(self, known: float) -> float:
        """The first speed that can be told of [turns/s]. known : what the motor has there [rad/s^2]"""
        ...

    def gently(self, pps2: float) -> None:
        """Move with this acceleration from now on, between runs."""
        ...

    async def begin(self) -> None:
        """What comes before the first run."""
        ...

    async def home(self) -> None:
        """To where the study began."""
        ...

    async def first(self) -> float | None:
        """What it has at the first speed [rad/s^2]; None where the chip cannot accelerate so that steps are lost."""
        ...

    async def top(self, pps2: float) -> tuple[float, bool]:
        """The greatest speed that is reached with an acceleration [turns/s], and whether steps were lost beyond."""
        ...

    async def at(self, speed_rps: float, known: float) -> TorquePoint | None:
        """What there is about a speed; None where it cannot be told. known : about what is expected [rad/s^2]"""
        ...


class TorqueCurveStudy(StudyRun):
    """Accelerates at each speed until steps are lost; nothing of the axis is other at its end."""

    _ground: Ground
    _runs: Accelerated

    @property
    def wanted(self) -> TorqueCurve:
        """What is looked for."""
        return self.record.document.wanted(TorqueCurve)

    async def _study(self) -> None:
        record, wanted = self.record, self.wanted
        await leave_switch(self, SWITCHES[wanted.seen_by])
        self.tell("preconditions", 0.0, "looking at the axis")
        ground = self._ground = (await look(self.device, self.axis, wanted)).required()
        if record.start is not None and ground.switch is None:
            # Cut off while it slipped, its counter is wrong: it is set right as after each run.
            await Slips(self, ground, wanted).run_out(ground.start)
            ground = self._ground = (await look(self.device, self.axis, wanted)).required()
        if await self.returned(ground.start):
            ground = self._ground = (await look(self.device, self.axis, wanted)).required()
        record.findings = []
        if not record.baseline:
            record.baseline = ground.space.before
            record.baseline_setting = ground.space.now()
        found = record.torque = record.torque or TorqueFound(
            inertia_kgm2=wanted.inertia_kgm2, friction_nm=wanted.friction_nm
        )
        self._runs = Slips(self, ground, wanted) if ground.switch is None else Ramps(self, ground, wanted)
        await self.keeper.save(record)
        await self._runs.begin()
        await self._curve(found)
        await self._runs.home()
        await self.back()
        self._judge(found)

    async def _curve(self, found: TorqueFound) -> None:
        if not found.speeds_rps:
            await self._range(found)
        first = found.first_radps2
        if first is None:
            return
        self._runs.gently(self._ground.pps2(GENTLY * first))
        many = len(found.speeds_rps)
        for index, speed_rps in enumerate(found.speeds_rps):
            if any(one.asked_rps == speed_rps for one in found.points):
                continue  # it was cut off after this one
            if self.spent():
                self.record.next = "more time, or way: not all speeds were looked at"
                break
            part = 0.15 + 0.85 * index / many
            self.tell("look", part, f"at {plain(speed_rps, 3)} turns/s", self._left_s(part))
            self.keeper.mark(f"at {plain(speed_rps, 3)} turns/s")
            slower = {one.asked_rps or 0.0: one for one in found.points if (one.asked_rps or 0.0) < speed_rps}
            known = slower[max(slower)].acceleration_radps2 if slower else first
            point = await self._runs.at(speed_rps, known)
            if point is not None:
                found.points.append(self._with_torque(point.model_copy(update={"asked_rps": speed_rps})))
                found.points.sort(key=lambda one: one.speed_rps)
                await self.keeper.save(self.record)

    async def _range(self, found: TorqueFound) -> None:
        """From which speed to which there is something to be found."""
        ground, wanted, runs = self._ground, self.wanted, self._runs
        self.tell("look", 0.0, f"accelerating from {LOW_RPS:g} turns/s until steps are lost")
        known = await runs.first()
        if known is None:
            found.at_least_radps2 = ground.radps2(ground.most[ACCELERATION])
            return
        runs.gently(ground.pps2(GENTLY * known))
        self.tell("look", 0.1, "looking how fast it turns at all")
        highest, ends = await runs.top(ground.pps2(TOP * known))
        if ends:
            found.speed_most_rps = highest
        first, last = runs.lowest_rps(known), BELOW_TOP * highest
        if last < 1.5 * first:
            raise Failed(
                f"already at {plain(highest, 3)} turns/s little torque is left: nothing to be drawn as a curve"
                if ends
                else f"it comes to {plain(highest, 3)} turns/s, and something can be told from {plain(first, 3)} on: "
                "more travel, or a higher greatest speed"
            )
        found.points = []
        found.first_radps2, found.speeds_rps = known, np.linspace(first, last, wanted.speeds).tolist()
        await self.keeper.save(self.record)

    def _left_s(self, part: float) -> float:
        return self.since_s / part * (1 - part)

    # --- what it tells ----------------------------------------------------------------------------

    def _with_torque(self, point: TorquePoint) -> TorquePoint:
        """The same with its torque, where the inertia was told."""
        wanted, mean, around = self.wanted, point.acceleration_radps2, point.interval_radps2
        if wanted.inertia_kgm2 is None:
            return point
        inertial = wanted.inertia_kgm2 * mean
        below, above = (
            inertial * math.hypot(abs(end - mean) / mean, wanted.inertia_share) for end in (around.low, around.high)
        )
        torque = inertial + wanted.friction_nm
        interval = Interval(low=torque - below, high=torque + above)
        return point.model_copy(update={"torque_nm": torque, "interval_nm": interval})

    def _margin(self, points: list[TorquePoint]) -> RampMargin:
        """What the ramp before asks for, against the least of what is there up to its speed."""
        now, ground = self._ground.space.now(), self._ground
        speed, asked = now[SPEED] / ground.turn, ground.radps2(now[ACCELERATION])
        within = [point for point in points if point.speed_rps <= speed] or points[:1]
        beyond = next((point for point in points if point.speed_rps > speed), None)
        # Torque falls with speed: what the next point above has is there at the ramp's speed as well.
        worst = min([*within, *([] if beyond is None else [beyond])], key=lambda point: point.acceleration_radps2)
        around = worst.interval_radps2
        return RampMargin(
            speed_rps=min(worst.speed_rps, speed),
            acceleration_radps2=asked,
            times=worst.acceleration_radps2 / asked,
            interval=Interval(low=around.low / asked, high=around.high / asked),
            whole=beyond is not None,
        )

    def _judge(self, found: TorqueFound) -> None:
        record = self.record
        if found.at_least_radps2 is not None:
            record.verdict = (
                f"no step is lost at the greatest acceleration that it may have: at {LOW_RPS:g} turns/s the motor has "
                f"more than {plain(found.at_least_radps2, 3)} rad/s^2{self._as_torque(found.at_least_radps2)}"
            )
            record.next = "more inertia, a coarser resolution of microsteps, or less current shows where its edge is"
            return
        if len(found.points) < 2:
            raise Failed("no two speeds showed a clear slip: more samples, a finer encoder, or more travel")
        found.margin = margin = self._margin(found.points)
        first, last = found.points[0], found.points[-1]
        what = (
            f"{plain(first.acceleration_radps2, 3)} rad/s^2{self._as_torque(first.acceleration_radps2)} at "
            f"{plain(first.speed_rps, 3)} turns/s, {plain(last.acceleration_radps2, 3)}"
            f"{self._as_torque(last.acceleration_radps2)} at {plain(last.speed_rps, 3)}"
        )
        inside = "" if margin.whole else " as far as it was looked at"
        record.verdict = f"{what}; {plain(margin.times, 3)} times what the ramp asks for{inside}"
        record.findings = [
            Finding(
                name="margin of the ramp",
                text=f"what the motor has, by what the ramp asks for, at its worst speed{inside}: an acceleration that "
                f"sets in at once, without S-shape, needs {SWING:.2f}, for the rotor swings",
                value=margin.times,
                interval=margin.interval,
            )
        ]
        if found.speed_most_rps is not None:
            record.findings.append(
                Finding(
                    name="greatest speed",
                    text=f"with {100 * TOP:g} % of the acceleration that it has at first steps were lost here",
                    value=found.speed_most_rps,
                    unit="turns/s",
                )
            )
        uneven = max(found.points, key=lambda point: abs(point.both_ways_radps2 or 0.0))
        around, apart = uneven.interval_radps2, uneven.both_ways_radps2
        if apart is not None and abs(apart) > around.high - around.low:
            record.findings.append(
                Finding(
                    name="both ways differ",
                    text="positive way less negative way, at worst: a weight or a spring pulls",
                    value=apart,
                    unit="rad/s^2",
                )
            )
        if found.inertia_kgm2 is None:
            record.findings.append(
                Finding(name="torque", text="the inertia was not told: torque is it times this", sure="cannot be told")
            )

    def _as_torque(self, radps2: float) -> str:
        wanted = self.wanted
        if wanted.inertia_kgm2 is None:
            return ""
        return f" ({plain(wanted.inertia_kgm2 * radps2 + wanted.friction_nm, 3)} N m)"
