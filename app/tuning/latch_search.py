"""Reference search of a TMC4361: both edges of a switch as the chip latches them, and zero in the middle (002, 9).

"left" and "right" are the stop switches: the motor runs into the switch, which stops it, and comes back out; X_LATCH
has both edges. "reference" is HOME_REF, which is crossed: home tracking puts first the one edge and then the other into
X_HOME. Where home lies nobody knows, so the search goes left, and turns at the left end if it has not met both edges.
"""

from __future__ import annotations

from collections.abc import Callable

from app.clock import Clock
from app.devices.results import AxisState
from app.devices.tmc4361.driver import Tmc4361
from app.links.errors import OutOfRange, WrongState
from app.tuning.edges import SLACK_S, Switch
from app.tuning.procedure import POLL_S, Failed
from app.tuning.search import ReferenceSearchState, Search, State

PHASES = ("prepare", "leave", "first edge", "second edge", "to the centre")
MAX_TRAVEL = 1 << 23
"""Default way after which a phase is given up [microsteps]: 163 turns at 256 microsteps."""
MARGIN = 8
"""HOME_SAFETY_MARGIN reaches so far beyond the edges [microsteps]."""
MARGIN_MAX = 0xFFFF
LOW_ACTIVE = (9, 11, 13)
"""home_event codes of a home switch whose zone is low."""
LEFT_EDGE = {True: 2, False: 13}
RIGHT_EDGE = {True: 4, False: 11}
"""home_event codes that put X_HOME at the left and the right end of the zone, by whether the zone is high."""
SIDES = {"left": ("stop_left_en", "latch_x_on_active_l", "latch_x_on_inactive_l")}
SIDES["right"] = ("stop_right_en", "latch_x_on_active_r", "latch_x_on_inactive_r")


class LatchSearch(Search):
    """Searches `switch` at `velocity_pps` (None: a quarter of VMAX), `max_travel` microsteps a phase at the most.

    At the end position zero is in the middle of the switch and the motor stands there, its target too. After a search
    for "reference" X_HOME is 0 and HOME_SAFETY_MARGIN covers the switch.
    """

    def __init__(
        self,
        device: Tmc4361,
        axis: int,
        clock: Clock,
        switch: Switch = "reference",
        velocity_pps: float | None = None,
        max_travel: int | None = None,
    ) -> None:
        super().__init__(device, axis, clock)
        if velocity_pps is not None and not velocity_pps > 0:
            raise OutOfRange("velocity", velocity_pps, 0, None, "above 0")
        if max_travel is not None and not 1 <= max_travel < 1 << 31:
            raise OutOfRange("max_travel", max_travel, 1, (1 << 31) - 1)
        self.switch = switch
        self._chip = device
        self._velocity_pps = velocity_pps
        self._max_travel = max_travel or MAX_TRAVEL
        self._speed_pps = 1.0
        self._how: State = "running"
        self._phase = PHASES[0]
        self._edges: list[int] = []
        self._centre: int | None = None
        self._offset: int | None = None
        self._before: dict[str, int] = {}
        """Fields of REFERENCE_CONF that were changed, as they were."""

    @property
    def state(self) -> ReferenceSearchState:
        progress = 1.0 if self._how == "done" else PHASES.index(self._phase) / len(PHASES)
        return ReferenceSearchState(
            self._how, self._phase, progress, list(self._edges), self._centre, self._offset, self.message
        )

    def _over(self, how: str) -> None:
        self._how = "done" if how == "done" else "failed" if how == "failed" else "aborted"

    async def _run(self) -> None:
        await self._prepare()
        if self.switch == "reference":
            await self._cross()
        else:
            await self._touch(self.switch)
        await self._finish()

    async def _prepare(self) -> None:
        chip = self._chip
        await self._halt()
        limit_pps = chip.cruise.speed / 256
        if limit_pps == 0:
            raise WrongState("the axis cannot move: VMAX is 0", "write VMAX, in 1/256 pps, first")
        wanted = limit_pps / 4 if self._velocity_pps is None else self._velocity_pps
        if wanted > limit_pps:
            raise OutOfRange("velocity", wanted, 0, limit_pps, "pps; VMAX is the limit")
        self._speed_pps = wanted

    # --- end switches ---------------------------------------------------------------------------

    async def _touch(self, side: Switch) -> None:
        enable, active, inactive = SIDES[side]
        # It has to stop the motor while it is searched, whatever it is used for otherwise.
        await self._borrow({enable: 1, active: 1, inactive: 1, "soft_stop_en": 0, "invert_stop_direction": 0})
        await self.clock.sleep(POLL_S)  # switched on, the flag of the switch follows its pin behind the input filter
        way = -1 if side == "left" else 1

        def met(state: AxisState) -> bool:
            return bool(state.switches.left if side == "left" else state.switches.right)

        if met(await self._look()):
            self._phase = "leave"
            await self._go(-way, lambda state: not met(state), f"the {side} switch stays active")
        self._phase = "first edge"
        await self._go(way, met, f"no edge of the {side} switch")
        self._edges.append((await self._chip.read("X_LATCH", self.axis)).value)
        self._phase = "second edge"
        await self._go(-way, lambda state: not met(state), f"the {side} switch stays active")
        self._edges.append((await self._chip.read("X_LATCH", self.axis)).value)

    # --- home -----------------------------------------------------------------------------------

    async def _cross(self) -> None:
        conf = (await self._chip.read("REFERENCE_CONF", self.axis)).fields
        high = conf["home_event"] not in LOW_ACTIVE
        self._before = {"home_event": conf["home_event"], "start_home_tracking": conf["start_home_tracking"]}
        # Going left the right end of the zone comes first. What is not met on the way is met on the way back.
        self._phase = "first edge"
        missing = {"right": RIGHT_EDGE[high], "left": LEFT_EDGE[high]}
        found: dict[str, int] = {}
        for way, order in ((-1, ("right", "left")), (1, ("left", "right")), (-1, ("right", "left"))):
            for end in order:
                if end in missing:
                    place = await self._track(way, missing[end])
                    if place is None:
                        break
                    found[end] = place
                    self._edges.append(place)
                    del missing[end]
                    self._phase = "second edge"
            await self._halt()
            if not missing:
                return
        raise Failed("the home switch was not met between the ends of the way")

    async def _track(self, way: int, home_event: int) -> int | None:
        """Go `way` until home tracking has an edge of that kind; None where the motor is stopped before."""
        await self._chip.write("REFERENCE_CONF", self.axis, fields={"home_event": home_event, "start_home_tracking": 1})
        tracking = True

        async def caught() -> bool:
            nonlocal tracking
            tracking = bool((await self._chip.read("REFERENCE_CONF", self.axis)).fields["start_home_tracking"])
            return not tracking

        state = await self._look()
        if not state.moving or state.velocity_pps * way <= 0:
            await self._chip.rotate(self.axis, way * self._speed_pps)
        began = state.position
        deadline_s = self._deadline()
        while not await caught():
            await self.clock.sleep(POLL_S)
            state = await self._look()
            if not state.moving and not await caught():
                return None
            if abs(state.position - began) > self._max_travel or self._chip.device_time_s() > deadline_s:
                raise Failed(f"no edge of the home switch within {abs(state.position - began)} microsteps")
        return (await self._chip.read("X_HOME", self.axis)).value

    # --- together -------------------------------------------------------------------------------

    async def _go(self, way: int, done: Callable[[AxisState], bool], failure: str) -> None:
        """Go `way` until `done`, and stop. Raises Failed where that does not come."""
        began = (await self._look()).position
        await self._chip.rotate(self.axis, way * self._speed_pps)
        deadline_s = self._deadline()
        while True:
            await self.clock.sleep(POLL_S)
            state = await self._look()
            if done(state):
                break
            if not state.moving:
                raise Failed(f"{failure}: the motor stands at {state.position}, {_blocker(state)}")
            if abs(state.position - began) > self._max_travel or self._chip.device_time_s() > deadline_s:
                raise Failed(f"{failure} within {abs(state.position - began)} microsteps")
        await self._halt()

    async def _finish(self) -> None:
        chip = self._chip
        self._phase = "to the centre"
        first, second = sorted(self._edges)
        self._centre = (first + second) // 2
        position = (await self._look()).position
        self._offset = await chip.set_position(self.axis, position - self._centre)
        notes = [f"edges {first} and {second}, zero at {self._centre}"]
        if self.switch == "reference":
            half = (second - first + 1) // 2 + MARGIN
            await chip.write("X_HOME", self.axis, value=0)
            await chip.write("HOME_SAFETY_MARGIN", self.axis, value=min(half, MARGIN_MAX))
            if half > MARGIN_MAX:
                notes.append(f"HOME_SAFETY_MARGIN ends at {MARGIN_MAX} and does not cover the whole switch")
        else:  # the last way leads into the active switch, where it has to be allowed to end
            await self._borrow({SIDES[self.switch][0]: 0})
        started = await chip.move(self.axis, 0)
        deadline_s = chip.device_time_s() + (started.predicted_duration_s or 0.0) + SLACK_S
        while not ((state := await self._look()).position_reached and not state.moving):
            if chip.device_time_s() > deadline_s:
                raise Failed(f"the centre was not reached: the motor is at {state.position}, {_blocker(state)}")
            await self.clock.sleep(POLL_S)
        self.message = "; ".join(notes)

    async def _halt(self) -> None:
        """Stop by the ramp and wait for rest: a latched edge is exact however far the motor runs on."""
        await self._chip.stop(self.axis)
        deadline_s = self._deadline()
        while (await self._look()).moving:
            if self._chip.device_time_s() > deadline_s:
                raise Failed("the motor did not come to rest")
            await self.clock.sleep(POLL_S)

    async def _look(self) -> AxisState:
        return await self._chip.axis_state(self.axis)

    def _deadline(self) -> float:
        """More than a way takes at the search speed, device time [s]."""
        return self._chip.device_time_s() + 1.5 * self._max_travel / self._speed_pps + SLACK_S

    async def _borrow(self, wanted: dict[str, int]) -> None:
        """Set fields of REFERENCE_CONF until `_give_back`."""
        held = (await self._chip.read("REFERENCE_CONF", self.axis)).fields
        for name in wanted:
            self._before.setdefault(name, held[name])
        await self._chip.write("REFERENCE_CONF", self.axis, fields=dict(wanted))

    async def _give_back(self) -> None:
        if self._before:
            await self._chip.write("REFERENCE_CONF", self.axis, fields=dict(self._before))


def _blocker(state: AxisState) -> str:
    active = [side for side in ("left", "right") if getattr(state.switches, side)]
    return f"the {' and '.join(active)} switch is active" if active else "nothing says why it stopped"
