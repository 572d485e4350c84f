"""Notices every move of an axis, whoever makes it, and hands it on with the setting that it was made with."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from ...clock import Clock
from ...devices.core.device import Device
from ...errors import BenchError, UnknownThing
from ...recording.service import axes_of, configuration_of
from ...telemetry.feed import Joined
from ...telemetry.hub import TelemetryHub
from ...telemetry.reader import Gap
from ..document import ScoredMove
from ..moves import RATE_HZ, stopped_by_a_stall
from .noticed import MoveFinder, NoticedMove
from .plan import Ground, look

BATCH_HZ = 20.0
AGAIN_S = 1.0
"""After a failure, and while the device is away, it looks again so much later [s]."""
QUANTITIES = ("position", "encoder_position", "velocity", "load_value")


@dataclass(frozen=True, slots=True)
class Setting:
    """What the axis and its device were set to as a move began."""

    ground: Ground
    configuration: Mapping[str, Any] | None
    axes: tuple[Mapping[str, Any], ...]


class MoveWatch:
    """Watches one axis until it is ended. noticed, missed : how many moves were scored, and could not be; message : why
    it does not watch now"""

    def __init__(
        self,
        device: Device,
        axis: int,
        clock: Clock,
        hub: TelemetryHub,
        busy: Callable[[], bool],
        keep: Callable[[NoticedMove, Setting, Joined, tuple[str, ...]], Awaitable[None]],
    ) -> None:
        """`busy` tells whether a procedure moves the axis, whose moves are its own; `keep` gets each move."""
        self.device, self.axis = device, axis
        self._clock, self._hub, self._busy, self._keep = clock, hub, busy, keep
        self._setting: Setting | None = None
        self._own = False
        """Whether the move under way is a procedure's."""
        self.noticed = self.missed = 0
        self.message = ""
        self._task = asyncio.create_task(self._run(), name=f"moves of {device.id} are noticed")

    @property
    def over(self) -> bool:
        """Whether it has ended by itself: its device is gone."""
        return self._task.done()

    async def end(self) -> None:
        """Notice no more."""
        self._task.cancel()
        await asyncio.gather(self._task, return_exceptions=True)

    async def _run(self) -> None:
        while True:
            try:
                if self.device.state == "connected":
                    await self._watch()
                else:
                    self.message = "the device is not connected"
            except UnknownThing as error:  # removed
                self.message = str(error)
                return
            except BenchError as error:
                self.message = str(error)
            await self._clock.sleep(AGAIN_S)

    async def _watch(self) -> None:
        """Until the device is away. Raises BenchError, UnknownThing where it is gone."""
        microsteps = self.device.axis(self.axis).microsteps
        if microsteps is None:
            self.message = "how many microsteps a turn has is not known: start the axis up"
            return
        there = {channel.name for channel in self.device.telemetry.channels()}
        channels = tuple(name for one in QUANTITIES if (name := f"{one}.{self.axis}") in there)
        joined = self._hub.join(self.device.id, channels, RATE_HZ, BATCH_HZ)
        finder, missed = MoveFinder(len(channels), microsteps[0]), self.missed
        reader, lost, moved = joined.reader, 0, False
        self.message = ""
        try:
            while reader.closed is None:
                await reader.wait()
                if any(isinstance(event, Gap) for event in reader.take_events()):
                    finder.gap()
                while (rows := reader.take_rows(self._clock.now())) is not None:
                    if rows.dropped > lost:
                        lost = rows.dropped
                        finder.gap()
                    for move in finder.feed(rows.time_s, rows.columns):
                        finder.missed += not await self._scored(move, joined, channels)
                        moved = False
                    self.missed = missed + finder.missed
                if finder.moving and not moved:
                    self._own = self._busy()
                    self._setting = None if self._own else await self._looked()
                moved = finder.moving
        finally:
            self._hub.leave(reader)

    async def _looked(self) -> Setting | None:
        """What is set now. Raises BenchError."""
        looked = await look(self.device, self.axis, ScoredMove(distance=1))
        if looked.ground is None:
            self.message = "; ".join(looked.missing)
            return None
        return Setting(looked.ground, await configuration_of(self.device), await axes_of(self.device))

    async def _scored(self, move: NoticedMove, joined: Joined, channels: tuple[str, ...]) -> bool:
        """Hand a move on; False for one that cannot be scored. Raises BenchError."""
        setting, self._setting = self._setting, None
        own, self._own = self._own, False
        if own or setting is None:
            return own  # else it was over before its setting could be read
        state = await self.device.monitor.axis_state(self.axis)
        if state.position == move.target and not state.position_reached:
            meant = state.target_position
            if meant is None or not await stopped_by_a_stall(self.device, self.axis, self._clock, move.sampled.began_s):
                return False  # stopped on its way, or turned at a speed: no ramp of it is whole
            move = replace(move, target=meant, stalled_at=move.target)
        await self._keep(move, setting, joined, channels)
        self.noticed += 1
        return True
