"""Which chip answers, by version and clock."""

from __future__ import annotations

from ...errors import OtherModel, WrongState
from ..core.background_tasks import BackgroundTasks
from ..core.capabilities import Identity
from ..core.register_link import RegisterLink
from ..core.unread_registers import NOTHING, on_board
from . import roles
from .events import Events
from .identity import is_one


class ChipIdentity(Identity):
    """Tells one TMC4361 from everything else; `tasks` are the driver's own, which end when it is let go."""

    def __init__(self, link: RegisterLink, events: Events, tasks: BackgroundTasks) -> None:
        self._link = link
        self._session = link.session
        self._events = events
        self._tasks = tasks

    async def probe(self) -> str:
        where = await on_board(self._link)
        async with self._link.turn() as turn:
            version, clock_hz = await self._link.io(turn).read_many((roles.VERSION, roles.CLK_FREQ))
        if is_one(version, clock_hz):
            return f"a TMC4361 answers, version {version}, CLK_FREQ {clock_hz / 1e6:g} MHz{where}"
        found = await self._session.models_found(self._link.access)
        if version == clock_hz and version in NOTHING and not found:
            raise WrongState(
                f"no TMC4361 answers here: all bits read {version & 1}", "check power, wiring and chip select"
            )
        raise OtherModel(
            f"this is no TMC4361: VERSION_NO reads {version:#010x} and CLK_FREQ {clock_hz:#010x}",
            self._session.model,
            found,
            foreign=True,
        )

    async def refresh(self) -> None:
        async with self._link.turn() as turn:
            await self._events.take(self._link.io(turn), roles.REMEMBERED)

    def only_reads(self, frame: bytes) -> bool:
        return self._link.access.is_read(frame)

    async def let_go(self) -> None:
        await self._tasks.end()
