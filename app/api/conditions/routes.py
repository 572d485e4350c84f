"""The socket of conditions: how all axes stand, then every change."""

from __future__ import annotations

import asyncio
import contextlib

from fastapi import WebSocket
from pydantic import ValidationError

from ...clock import BackgroundClock
from ...conditions.service import AxisAssessment, ConditionService
from ...devices.core.device import Device
from ..http.sockets import accepted, until_one_ends
from ..policy import policy
from ..router import subject_router
from ..server_state import ServerState
from .pages import Pages
from .schemas import (
    SUBPROTOCOL,
    Alive,
    AxisCondition,
    ConditionsPage,
    ConditionsSnapshot,
    ConditionsText,
    DeviceRemoved,
)
from .views import standing_out

ALIVE_S = 1.0
"""How long nothing is said at the most: whoever hears nothing for longer knows nothing any more."""

router = subject_router(tags=["conditions"])


@router.websocket("/conditions")
@policy(role="look")
async def conditions(socket: WebSocket) -> None:
    """Tell how every axis stands: a snapshot, then what changes, and each second at least a sign of life.

    A page of a session first says whose it is: when the last one of the bench's holder ends, it has left.
    """
    if not await accepted(socket, SUBPROTOCOL):
        return
    bench: ServerState = socket.app.state.bench
    news = News(bench.conditions)
    try:
        await until_one_ends(
            _send(socket, bench.conditions, news, bench.background),
            _hear(socket, bench.pages),
            name="conditions socket",
        )
    finally:
        news.end()


class News:
    """What one reader has not been told yet: of each axis the latest alone, so that a slow reader costs no more."""

    def __init__(self, conditions: ConditionService) -> None:
        self._waiting: dict[tuple[str, int], AxisAssessment | None] = {}
        self._arrived = asyncio.Event()
        self.end = conditions.listen(self._hear)

    def _hear(self, device: str, axis: int, standing: AxisAssessment | None) -> None:
        self._waiting.pop((device, axis), None)  # the latest comes last
        self._waiting[device, axis] = standing
        self._arrived.set()

    async def next(self) -> list[tuple[str, int, AxisAssessment | None]]:
        """Wait for news; all of it, oldest first."""
        await self._arrived.wait()
        self._arrived.clear()
        waiting, self._waiting = self._waiting, {}
        return [(device, axis, standing) for (device, axis), standing in waiting.items()]


async def _send(socket: WebSocket, conditions: ConditionService, news: News, clock: BackgroundClock) -> None:
    await _say(socket, ConditionsSnapshot(axes=[_message(*one) for one in conditions.all()]))
    while True:
        gone: set[str] = set()
        try:
            heard = await asyncio.wait_for(news.next(), ALIVE_S)
        except TimeoutError:
            heard = []
        await clock.turn()  # many wake at once: not all of them before a stop
        if not heard:
            await _say(socket, Alive())
        for device_id, axis, standing in heard:
            device = conditions.device(device_id)
            if standing is not None and device is not None:
                gone.discard(device_id)
                await _say(socket, _message(device, axis, standing))
            elif device_id not in gone:
                gone.add(device_id)
                await _say(socket, DeviceRemoved(device=device_id))


def _message(device: Device, axis: int, standing: AxisAssessment) -> AxisCondition:
    return AxisCondition(device=device.id, axis=axis, **standing_out(device, standing))


async def _hear(socket: WebSocket, pages: Pages) -> None:
    """Return when the reader has gone. A page says whose it is; what else is said means nothing."""
    with contextlib.ExitStack() as stack:
        said = False
        while (message := await socket.receive())["type"] != "websocket.disconnect":
            if not said and (page := _page(message.get("text"))) is not None:
                stack.enter_context(pages.page(page.session))
                said = True


def _page(text: str | None) -> ConditionsPage | None:
    try:
        return ConditionsPage.model_validate_json(text or "")
    except ValidationError:
        return None


async def _say(socket: WebSocket, message: ConditionsText) -> None:
    await socket.send_text(message.model_dump_json())
