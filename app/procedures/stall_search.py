"""Sensorless homing: the motor runs against the end of its stage, and the stall that its driver measures stops it
(FM-PD42-1241 7.2; DS-TMC5160 14).

First it goes the other way, to see whether that can work: whether it gets up to speed, and whether the load value says
at that speed that nothing is in the way. Then it runs into the end, several times; how far the places of these hits
are apart tells whether steps were lost. A hit stops the field 1 to 2 full steps beyond where the rotor stands: the
load value is one of a full step, and with 2 the rotor would slip. Zero is where the rotor stands, by the middle of
that.

StealthChop is off meanwhile, for StallGuard2 measures with SpreadCycle only; afterwards it is as before, whatever
became of the search.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..clock import Clock
from ..devices.core.capabilities import StallStop
from ..devices.core.device import Device
from ..devices.core.results import AxisState, RegisterReading, WriteItem
from ..errors import CannotMove, OutOfRange
from .procedure import POLL_S, Failed
from .search import SLACK_S, ReferenceSearchState, Search, check_figures

PHASES = ("prepare", "check", "search", "back off", "hit again", "to zero")
Side = Literal["left", "right"]
MAX_TRAVEL = 1 << 20
"""Default way of the search after which it is given up [microsteps]: 20 turns at 256 microsteps."""
HITS = (1, 10)
USUAL_HITS = 3
FIELD_AHEAD = 1.5
"""By how much a hit stops the field beyond the rotor [full steps], +-0.5."""
SPREAD = 2.0
"""By how much hits may differ [full steps]: a rotor that slips does so by 4."""
STALL_ABOVE = 0.8
"""Share of the search speed from which on a stall stops the motor: below, while it speeds up, the value says little."""
FREE_LOAD = 20
"""What the load value must not fall below with nothing in the way: twice its noise [counts]."""
GOOD_LOAD = (60, 300)
"""Lowest load value with nothing in the way that a threshold found by itself aims at [counts]."""
COUNTS_A_THRESHOLD = 8
"""What one more of the threshold adds to the load value, about [counts]."""
THRESHOLDS = (-64, 63)
FOUND_AT_MOST = 10
"""The highest threshold that is found by itself: the maker's demos end at 9, and with much more nothing is a stall."""
CHECKED_S = 0.1
"""How long the load value is looked at on the way away from the end, device time [s]."""
ROUNDS = 3
"""How often a threshold is looked for."""
GRINDS_S = 0.4
"""For so long the load value may be less than half of what it is with nothing in the way before the motor is stopped
[s]: it stands against the end, and the value does not get to 0."""
FOLLOWS = 4.0
"""How far an encoder may be from the position [full steps] before the motor is stopped: so far a rotor slips."""
SAYS_WHY_S = 1.0
"""How long the driver may take to tell why the motor rests [s]."""


@dataclass(frozen=True, slots=True)
class StallWanted:
    """None: `velocity_pps` a turn a second, or the axis's limit if that is less; the current as it is set; a threshold
    that is found; `back_off` the way that the motor needs to get up to speed [microsteps]."""

    side: Side = "left"
    velocity_pps: float | None = None
    threshold: int | None = None
    current_percent: float | None = None
    """Of the driver's full scale."""
    back_off: int | None = None
    hits: int = USUAL_HITS
    max_travel: int | None = None


class StallSearch(Search):
    """Searches the end of the stage at one side. At the end zero is there, and the motor stands there."""

    def __init__(self, device: Device, axis: int, clock: Clock, wanted: StallWanted) -> None:
        """Raises WrongState for a device that measures no load, OutOfRange for what cannot be."""
        super().__init__(device, axis, clock)
        check_figures(wanted.velocity_pps, wanted.max_travel, 31)
        if not HITS[0] <= wanted.hits <= HITS[1]:
            raise OutOfRange("hits", wanted.hits, *HITS)
        if wanted.threshold is not None and not THRESHOLDS[0] <= wanted.threshold <= THRESHOLDS[1]:
            raise OutOfRange("threshold", wanted.threshold, *THRESHOLDS)
        if wanted.current_percent is not None and not 0 < wanted.current_percent <= 100:
            raise OutOfRange("current_percent", wanted.current_percent, 0, 100, "of full scale, above 0")
        self._stall = device.need(StallStop)
        self._wanted = wanted
        self._way = -1 if wanted.side == "left" else 1
        self._max_travel = wanted.max_travel or MAX_TRAVEL
        self._phase = PHASES[0]
        self._hits: list[int] = []
        self._zero: int | None = None
        self._full_step = 1
        self._speed_pps = 1.0
        self._threshold = 0
        self._free_load = 0
        self._run_up = 0
        self._set_aside = ""
        self._before: list[WriteItem] = []
        """What was set before, the latest write last."""

    @property
    def state(self) -> ReferenceSearchState:
        done = len(self._hits) / self._wanted.hits if self._phase == PHASES[4] else 0
        progress = 1.0 if self._how == "done" else (PHASES.index(self._phase) + done) / len(PHASES)
        return ReferenceSearchState(
            self._how, self._phase, progress, list(self._hits), self._zero, self._zero, self.message,
            last_position=self._zero, stall=True,
        )  # fmt: skip

    async def _run(self) -> None:
        await self._prepare()
        self._phase = "check"
        await self._check()
        await self._set(self._threshold, stops=True)
        self._phase = "search"
        await self._hit(self._max_travel)
        back_off = self._wanted.back_off or self._run_up
        for _ in range(self._wanted.hits - 1):
            self._phase = "back off"
            await self._go_by(-self._way * back_off)
            self._phase = "hit again"
            await self._hit(2 * back_off + 8 * self._full_step)
        await self._finish()

    # --- whether it can work ----------------------------------------------------------------------

    async def _prepare(self) -> None:
        await self._halt()
        self._full_step = await self._stall.full_step(self.axis)
        limit_pps = self._stall.cruise_pps(self.axis)
        if not limit_pps:
            told = "its maximum speed is 0" if limit_pps == 0 else "nobody knows its maximum speed"
            raise CannotMove(f"the axis cannot move: {told}", "write the maximum speed", self.axis)
        turn = self.device.axes[self.axis].settings.full_steps_per_rev * self._full_step
        wanted = min(float(turn), limit_pps) if self._wanted.velocity_pps is None else self._wanted.velocity_pps
        if wanted > limit_pps:
            raise OutOfRange("velocity", wanted, 0, limit_pps, "pps; the axis's maximum speed is the limit")
        self._speed_pps = wanted
        given = self._wanted.threshold
        self._threshold = await self._stall.stall_threshold(self.axis) if given is None else given
        self._set_aside = await self._stall.set_aside(self.axis)
        await self._set(self._threshold, stops=False)

    async def _check(self) -> None:
        """Go away from the end, and look at the load with nothing in the way; find a threshold where none was given."""
        for _ in range(ROUNDS):
            lowest = await self._free_run()
            low, high = GOOD_LOAD
            wrong = low - lowest if lowest < low else min(high - lowest, 0)
            if self._wanted.threshold is not None or not wrong:
                break
            step = 16 if not lowest else -(-abs(wrong) // COUNTS_A_THRESHOLD)  # 0 does not say how far it is below
            moved = self._threshold + (step if wrong > 0 else -step)
            moved = max(THRESHOLDS[0], min(FOUND_AT_MOST, moved))
            if moved == self._threshold:
                break
            self._threshold = moved
            await self._set(moved, stops=False)
        self._free_load = lowest
        if lowest < FREE_LOAD:
            raise Failed(
                f"with nothing in the way the load value falls to {lowest} at {self._speed_pps:.0f} pps and threshold "
                f"{self._threshold}: the motor would stop anywhere. Take a higher threshold or another speed, or see "
                "whether it turns freely"
            )

    async def _free_run(self) -> int:
        """Lowest load value at the search speed, away from the end."""
        began = (await self._read_axis()).position
        await self.device.motion.rotate(self.axis, -self._way * self._speed_pps)
        deadline_s = self._deadline(self._max_travel)
        reached: AxisState | None = None
        loads: list[int] = []
        while reached is None or (await self._read_axis()).time_s < reached.time_s + CHECKED_S or len(loads) < 4:
            await self.clock.sleep(POLL_S)
            state = await self._read_axis()
            way = abs(state.position - began)
            if not state.moving and way > self._full_step:
                raise Failed(f"the motor stopped on the way away from the end: {self._why(state)}")
            if way > self._max_travel or self.device.device_time_s() > deadline_s:
                raise Failed(f"the motor does not get to {self._speed_pps:.0f} pps within {way} microsteps")
            if reached is None and abs(state.velocity_pps) >= 0.98 * self._speed_pps:
                reached = state
                self._run_up = way + 8 * self._full_step
                await self.clock.sleep(8 * self._full_step / self._speed_pps)  # the first values are of the ramp
            elif reached is not None:
                loads.append(await self._stall.load(self.axis))
        await self._halt()
        if min(loads) < max(loads) / 2:
            raise Failed(
                f"on the way away from the end the load value goes from {min(loads)} to {max(loads)}: something is in "
                "the way there, or the speed is one at which the motor resonates"
            )
        return min(loads)

    # --- hits -------------------------------------------------------------------------------------

    async def _hit(self, most: int) -> None:
        """Run into the end. Raises Failed where something else happens, or nothing within `most` microsteps."""
        began = await self._read_axis()
        await self.device.motion.rotate(self.axis, self._way * self._speed_pps)
        deadline_s = self._deadline(most)
        fast = False
        low_since_s: float | None = None
        apart = began.deviation or 0.0
        while True:
            await self.clock.sleep(POLL_S)
            state = await self._read_axis()
            way = abs(state.position - began.position)
            if not state.moving and (fast or way or state.time_s > began.time_s + SAYS_WHY_S):
                break
            fast = fast or abs(state.velocity_pps) >= 0.98 * self._speed_pps
            if way > most or self.device.device_time_s() > deadline_s:
                raise Failed(f"nothing stopped the motor within {way} microsteps")
            if state.moving and abs((state.deviation or 0.0) - apart) > FOLLOWS * self._full_step:
                raise Failed(
                    f"the encoder shows that the motor stands, and no stall has stopped it: take a threshold below "
                    f"{self._threshold}"
                )
            if fast:
                load = await self._stall.load(self.axis)
                if load * 2 > self._free_load:
                    low_since_s = None
                elif low_since_s is None:
                    low_since_s = state.time_s
                elif state.time_s - low_since_s > GRINDS_S:
                    raise Failed(
                        f"the load value fell from {self._free_load} to {load} and not to 0, with which a stall stops "
                        f"the motor: take a threshold below {self._threshold}"
                    )
        why = await self._reason(began.time_s)
        if why != "stall":
            raise Failed(f"the motor stopped at {state.position} and no stall did that: {why or self._why(state)}")
        if not fast:
            raise Failed(f"a stall stopped the motor at {state.position} before it was at the search speed")
        self._hits.append(state.position)

    async def _reason(self, since_s: float) -> str:
        """Why the motor rests, as the driver tells; empty where it does not."""
        deadline_s = self.clock.now() + SAYS_WHY_S
        while self.clock.now() < deadline_s:
            ends = self.device.monitor.motion_ends(self.axis)
            if ends and ends[-1].time_s > since_s:
                return "stall" if ends[-1].reason == "stall" else ends[-1].detail
            await self.clock.sleep(POLL_S)
        return ""

    def _why(self, state: AxisState) -> str:
        active = [side for side in ("left", "right") if getattr(state.switches, side)]
        return f"the {' and '.join(active)} switch is active" if active else "nothing says why"

    async def _finish(self) -> None:
        spread = max(self._hits) - min(self._hits)
        if spread > SPREAD * self._full_step:
            raise Failed(
                f"the hits are {spread / self._full_step:.1f} full steps apart: the motor loses steps there. Take less "
                "speed or current, or a lower threshold"
            )
        self._phase = "to zero"
        await self._set(self._threshold, stops=False)
        ahead = round(FIELD_AHEAD * self._full_step)
        self._zero = self._hits[-1] - self._way * ahead
        at = (await self._read_axis()).position - self._zero
        await self._stall.call_here(self.axis, at)
        await self._go_to(0)
        apart = f" within {spread} microsteps" if len(self._hits) > 1 else ""
        self.message = (
            f"the {self._wanted.side} end is at {self._zero} of the old counting, +-{self._full_step // 2}: "
            f"{len(self._hits)} hit{'s' if len(self._hits) > 1 else ''}{apart}, threshold {self._threshold}, load "
            f"{self._free_load} with nothing in the way"
            f"{f'; {self._set_aside} was off meanwhile' if self._set_aside else ''}"
        )

    # --- together ---------------------------------------------------------------------------------

    async def _go_by(self, way: int) -> None:
        await self._go_to((await self._read_axis()).position + way)

    async def _go_to(self, target: int) -> None:
        started = await self.device.motion.move(self.axis, target)
        deadline_s = self.device.device_time_s() + (started.predicted_duration_s or 0.0) + SLACK_S
        while not ((state := await self._read_axis()).position_reached and not state.moving):
            if self.device.device_time_s() > deadline_s:
                raise Failed(f"{target} was not reached: the motor is at {state.position}, {self._why(state)}")
            await self.clock.sleep(POLL_S)

    async def _halt(self) -> None:
        await self.device.stop(self.axis)
        deadline_s = self._deadline(self._max_travel)
        while (await self._read_axis()).moving:
            if self.device.device_time_s() > deadline_s:
                raise Failed("the motor did not come to rest")
            await self.clock.sleep(POLL_S)

    async def _read_axis(self) -> AxisState:
        return await self.device.monitor.axis_state(self.axis)

    def _deadline(self, way: int) -> float:
        """More than a way takes at the search speed, device time [s]."""
        return self.device.device_time_s() + 1.5 * way / self._speed_pps + SLACK_S

    async def _set(self, threshold: int, *, stops: bool) -> None:
        """Write what makes a stall stop the motor, or not; what was there before is noted once."""
        writes = await self._stall.stall_writes(
            self.axis, STALL_ABOVE * self._speed_pps, threshold, self._wanted.current_percent, stops=stops
        )
        registers = self.device.registers
        if not self._before:
            for item in writes:
                known = self._stall.set_before(item)
                if known is not None:
                    self._before.append(known)
                    continue
                held = await self._held(item)
                fields: dict[str, int | str] | None = None
                if item.fields is not None:
                    fields = {name: held.fields[name] for name in item.fields}
                self._before.append(WriteItem(item.name, item.axis, held.value if fields is None else None, fields))
        for item in writes:
            await registers.write(item.name, item.axis, item.value, item.fields)

    async def _held(self, item: WriteItem) -> RegisterReading:
        """What a register holds, or is known to hold where it cannot be read."""
        registers = self.device.registers
        for kept in registers.kept(item.axis):
            if kept.name == item.name and kept.axis == item.axis:
                return kept
        return await registers.read(item.name, item.axis)

    async def _give_back(self) -> None:
        before, self._before = self._before, []
        for item in before:
            await self.device.registers.write(item.name, item.axis, item.value, item.fields)
