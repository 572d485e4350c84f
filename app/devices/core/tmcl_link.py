"""The way to a module: commands in turns, how many of them its wire carries, and noise on it."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager
from typing import Protocol

from ...errors import BadReply, LinkError
from ...links.queue import Priority
from ...links.tmcl import Request
from ...registers.model import Register
from .background_tasks import BackgroundTasks
from .config import DeviceConfig
from .session import Session
from .tmcl_calls import Calls, Lacking

NOISE_S = 0.05
"""How long a garbled answer may be the latest news of the link before it counts as failed [s]."""
CHUNK_S = 0.02
"""How long a reading of many parameters may keep other commands waiting [s]."""
CHUNKS = (4, 64)
"""Fewest and most questions of one turn."""
ADDRESS = 1
"""Of a module as it comes (GP 0, 66)."""


class Heard(Protocol):
    """What a driver remembers of its module, as the way to it needs that."""

    @property
    def lacking(self) -> Lacking:
        """Rows that this module does not have."""
        ...

    @property
    def unit_mode(self) -> int | None:
        """What its speeds count in, where a parameter of that name says so (AP 255)."""
        ...

    @property
    def questions(self) -> int:
        """How many questions one reading of an axis takes."""
        ...

    def saw(self, register: Register, value: int) -> None:
        """The module was seen to hold `value`."""
        ...


class TmclLink:
    """Sends commands to the module at `address`; what they tell, `state` hears."""

    def __init__(self, session: Session, state: Heard, tasks: BackgroundTasks) -> None:
        self._session = session
        self._state = state
        self._tasks = tasks
        self.address = _address(session.config)

    @asynccontextmanager
    async def calls(self, axis: int | None = None, priority: Priority = Priority.COMMAND) -> AsyncIterator[Calls]:
        """Commands in one turn; with `axis` they give up when a stop of that axis overtakes them."""
        session, state = self._session, self._state
        guard = None if axis is None else session.stop_guard([axis])
        async with session.queue.turn(priority, guard) as turn:
            calls = Calls(turn, session.port.name, self.address, state.saw, state.lacking)
            calls.unit_mode = state.unit_mode
            yield calls

    def check_limits(self, request: Request) -> None:
        """Raises SoftLimit before anybody is told of a command that will not go out."""
        if self._session.limiter is not None:
            self._session.limiter.check((request.encode(),))

    # --- what the wire carries ------------------------------------------------------------------

    @property
    def poll_spread_s(self) -> float:
        """How long the questions of one reading of the axis take on this link, about [s]."""
        possible = self._session.calls_per_s_possible
        return 0.0 if possible is None else self._state.questions / possible

    def shares(self, wanted: Sequence[Register]) -> Iterator[Sequence[Register]]:
        """`wanted` in as many turns as other commands need."""
        possible = self._session.calls_per_s_possible
        size = CHUNKS[1] if possible is None else max(CHUNKS[0], min(CHUNKS[1], round(possible * CHUNK_S)))
        return (wanted[first : first + size] for first in range(0, len(wanted), size))

    # --- noise ----------------------------------------------------------------------------------

    def counts(self, error: LinkError | None) -> bool:
        """`Session.link_filters`: a garbled answer on a line that works is asked again at once, so that the link has
        failed only where that fails too."""
        if isinstance(error, BadReply) and self._session.state == "connected":
            self._tasks.begin(self._judge_noise(), f"noise {self._session.id}")
            return False
        return True

    async def _judge_noise(self) -> None:
        session = self._session
        await session.clock.sleep(NOISE_S)
        if session.queue.error is not None and session.state == "connected":
            session.link_result(session.queue.error)


def _address(config: DeviceConfig) -> int:
    address = config.link.get("address", ADDRESS)
    return address if isinstance(address, int) else ADDRESS
