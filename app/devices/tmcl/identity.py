"""Which module answers, and what is read again now and then of what the driver remembers."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from itertools import cycle

from ...errors import DownloadMode, OtherModel, WrongState
from ...links.download import DownloadHold
from ...links.tmcl import Request, is_retriable, module_version
from ...registers.tmcl.commands import Opcode, Status
from ..core.background_tasks import BackgroundTasks
from ..core.capabilities import Identity
from ..core.session import Session
from ..core.signs import Remedy
from ..core.tmcl_link import TmclLink
from .state import ModuleState

REFRESHED = 4
"""How many of the remembered parameters each `refresh` reads again."""
DOWNLOADING = 129
"""The global parameter that is 1 in download mode, where it cannot be read: the question is stored, status 101."""
LEAVE_DOWNLOAD = Remedy("leave download mode", "POST", "tmcl", {"command": 133, "type": 0, "motor": 0, "value": 0})


class ModuleIdentity(Identity):
    """Asks the module who it is.

    refreshed : awaited after each `refresh`
    tasks : what the driver does on its own
    """

    def __init__(
        self,
        session: Session,
        state: ModuleState,
        link: TmclLink,
        download: DownloadHold,
        tasks: BackgroundTasks,
        refreshed: Callable[[], Awaitable[None]],
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._download = download
        self._tasks = tasks
        self._refreshed = refreshed
        self._next_parameter = cycle(state.roles.remembered)

    async def probe(self) -> str:
        session, module, address = self._session, self._state.module, self._link.address
        async with self._link.calls() as calls:
            reply = await calls.do(Request(address, Opcode.GET_VERSION, 1))
            number, version = module_version(reply.value)
            if number != module.number:
                wanted = f"a {session.family.title} (module {module.number})"
                raise OtherModel(f"this is a module {number}, firmware {version}, not {wanted}", session.model)
            # Alone: where the module is in download mode already, this one question tells, and is stored.
            told = await calls.reply(Request(address, Opcode.GGP, DOWNLOADING))
        if told.status == Status.OK and told.value:
            self._download.downloads.begin(self._download.address, f"global parameter {DOWNLOADING} is {told.value}")
        if (problem := self._download.problem) is not None:
            raise problem
        self._state.firmware = version
        found = f"{session.family.title}, firmware {version}, address {address}"
        known = module.firmware
        return found if version == known else f"{found}; stepscope knows {known}, so parameters may differ"

    async def refresh(self) -> None:
        state = self._state
        unknown = [row for row in state.roles.remembered if state.last(row) is None and not state.lacking.has(row)]
        wanted = unknown or [next(self._next_parameter) for _ in range(REFRESHED)]
        async with self._link.calls() as calls:
            await calls.ask_many((*state.roles.always_fresh, *wanted))
        await self._refreshed()

    @property
    def shortcomings(self) -> tuple[str, ...]:
        names = ", ".join(f"{row.name} ({row.alias})" for row in self._state.lacking.rows)
        if not names:
            return ()
        return (f"its firmware {self._state.firmware} does not have {names}: what needs that is missing or refused",)

    def only_reads(self, frame: bytes) -> bool:
        return is_retriable(frame)

    def ways_out(self, why: WrongState) -> tuple[Remedy, ...]:
        return (LEAVE_DOWNLOAD,) if isinstance(why, DownloadMode) else ()

    async def let_go(self) -> None:
        await self._tasks.end()
