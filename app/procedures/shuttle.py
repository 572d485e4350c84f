"""Back and forth between two positions until stopped: something to look at while tuning."""

from __future__ import annotations

from dataclasses import dataclass

from ..clock import Clock
from ..devices.core.device import Device
from ..errors import OutOfRange
from .procedure import POLL_S, Ended, Failed, Procedure
from .standing import Standing

DWELL_MAX_S = 60.0
LOOK_S = 0.25
"""How seldom a motor under way is looked at [s]."""


@dataclass(frozen=True, slots=True)
class ShuttleState:
    """Names as in the REST contract."""

    running: bool
    first: int | None
    second: int | None
    dwell_s: float | None
    cycles: int
    message: str


IDLE = ShuttleState(False, None, None, None, 0, "")


class Shuttle(Procedure):
    """Moves to `first`, rests `dwell_s` [s], moves to `second`, rests, and so on. Positions in microsteps."""

    kind = "shuttle"

    def __init__(self, device: Device, axis: int, clock: Clock, first: int, second: int, dwell_s: float) -> None:
        super().__init__(device, axis, clock)
        if first == second:
            raise OutOfRange("second", second, None, None, "has to be another position than first")
        if not 0 <= dwell_s <= DWELL_MAX_S:
            raise OutOfRange("dwell_s", dwell_s, 0, DWELL_MAX_S)
        self.first, self.second, self.dwell_s = first, second, dwell_s
        self.cycles = 0

    @property
    def state(self) -> ShuttleState:
        return ShuttleState(self.running, self.first, self.second, self.dwell_s, self.cycles, self.message)

    async def _run(self) -> None:
        while True:
            for target in (self.first, self.second):
                await self._go(target)
                await self.clock.sleep(self.dwell_s)
            self.cycles += 1

    async def _go(self, target: int) -> None:
        started = await self.device.motion.move(self.axis, target)
        there_s = started.started_at_s + (started.predicted_duration_s or 0.0)
        pause_s, standing = POLL_S, Standing()
        while True:
            device_s, server_s = self.device.device_time_s(), self.clock.now()
            await self.clock.sleep(pause_s)
            # Early on the way nobody needs to look often. Device time may run faster or slower than ours.
            rate = (self.device.device_time_s() - device_s) / (self.clock.now() - server_s)
            left_s = (there_s - self.device.device_time_s()) / rate if rate > 0 else LOOK_S
            pause_s = min(max(left_s / 2, POLL_S), LOOK_S)
            state = await self.device.monitor.axis_state(self.axis)
            if state.position_reached and not state.moving:
                return
            if standing.seen(state):
                raise Failed(f"the motor stands at {state.position}, not {target}: by a switch, or v_max or a_max is 0")

    def _over(self, how: Ended) -> None:
        self.message = self.message or how

    async def _give_back(self) -> None:
        """It borrows nothing."""
