"""Reference search of a TMC4361: both edges of a switch as the chip latches them, and zero in the middle.

DS-TMC4361 9. "left" and "right" are the stop switches. "reference" is HOME_REF, which is crossed: home tracking puts
first the one edge and then the other into X_HOME. Where home lies nobody knows, so the search goes left, and turns at
the left end if it has not met both edges.
"""

from __future__ import annotations

from ...clock import Clock
from ...devices.core.device import Device
from ...devices.tmc4361.position import Position
from ..procedure import POLL_S, Failed
from ..search import Switch
from ..stop_search import MAX_TRAVEL, Latching, StopSearch

MARGIN = 8
"""HOME_SAFETY_MARGIN reaches so far beyond the edges [microsteps]."""
MARGIN_MAX = 0xFFFF
LOW_ACTIVE = (9, 11, 13)
"""home_event codes of a home switch whose zone is low."""
LEFT_EDGE = {True: 2, False: 13}
RIGHT_EDGE = {True: 4, False: 11}
"""home_event codes that put X_HOME at the left and the right end of the zone, by whether the zone is high."""


class LatchSearch(StopSearch):
    """As `StopSearch`. After a search for "reference" X_HOME is 0 and HOME_SAFETY_MARGIN covers the switch."""

    latching = Latching(
        latch="X_LATCH",
        switches="REFERENCE_CONF",
        sides={
            "left": ("stop_left_en", "latch_x_on_active_l", "latch_x_on_inactive_l"),
            "right": ("stop_right_en", "latch_x_on_active_r", "latch_x_on_inactive_r"),
        },
        off=("soft_stop_en", "invert_stop_direction"),
    )

    def __init__(
        self,
        device: Device,
        axis: int,
        clock: Clock,
        switch: Switch = "reference",
        velocity_pps: float | None = None,
        max_travel: int | None = None,
    ) -> None:
        position = device.part(Position)
        assert position is not None  # no other device is searched by this
        super().__init__(device, position, axis, clock, switch, velocity_pps, max_travel)

    async def _find(self) -> None:
        if self.switch == "reference":
            await self._cross()
        else:
            await super()._find()

    # --- home -----------------------------------------------------------------------------------

    async def _cross(self) -> None:
        conf = (await self.device.registers.read("REFERENCE_CONF", self.axis)).fields
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
        await self.device.registers.write(
            "REFERENCE_CONF", self.axis, fields={"home_event": home_event, "start_home_tracking": 1}
        )
        tracking = True

        async def caught() -> bool:
            nonlocal tracking
            tracking = bool(
                (await self.device.registers.read("REFERENCE_CONF", self.axis)).fields["start_home_tracking"]
            )
            return not tracking

        state = await self._read_axis()
        if not state.moving or state.velocity_pps * way <= 0:
            await self.device.motion.rotate(self.axis, way * self._speed_pps)
        began = state.position
        deadline_s = self._deadline()
        while not await caught():
            await self.clock.sleep(POLL_S)
            state = await self._read_axis()
            if not state.moving and not await caught():
                return None
            if abs(state.position - began) > self._max_travel or self.device.device_time_s() > deadline_s:
                raise Failed(f"no edge of the home switch within {abs(state.position - began)} microsteps")
        return (await self.device.registers.read("X_HOME", self.axis)).value

    async def _at_zero(self, width: int) -> list[str]:
        if self.switch != "reference":
            return await super()._at_zero(width)
        half = (width + 1) // 2 + MARGIN
        await self.device.registers.write("X_HOME", self.axis, value=0)
        await self.device.registers.write("HOME_SAFETY_MARGIN", self.axis, value=min(half, MARGIN_MAX))
        if half > MARGIN_MAX:
            return [f"HOME_SAFETY_MARGIN ends at {MARGIN_MAX} and does not cover the whole switch"]
        return []


__all__ = ["MAX_TRAVEL", "LatchSearch"]
