"""Which module answers: what it calls itself, beside what its title says."""

from __future__ import annotations

import re

from ...errors import OtherModel
from ...links.tmcl import Request, is_retriable, module_version
from ...registers import catalog
from ...registers.tmcl.commands import Opcode
from ..core.background_tasks import BackgroundTasks
from ..core.capabilities import Identity
from ..core.session import Session
from ..core.tmcl_link import TmclLink
from .state import ListedState

DEPTH = (
    "of its parameters the names are known, no ranges, no units and no calculators: velocities are the module's own "
    "numbers, positions its counts"
)


class ListedIdentity(Identity):
    """Asks the module who it is. Modules call themselves by the number in their title."""

    def __init__(self, session: Session, state: ListedState, link: TmclLink, tasks: BackgroundTasks) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._tasks = tasks

    async def probe(self) -> str:
        """Raises OtherModel where it calls itself by the number of another model that the catalog lists."""
        session, state, address = self._session, self._state, self._link.address
        async with self._link.calls() as calls:
            reply = await calls.do(Request(address, Opcode.GET_VERSION, 1))
        number, firmware = module_version(reply.value)
        state.answered(firmware)
        own = session.family.title
        state.calls_itself = ""
        if str(number) not in re.findall(r"\d+", own):
            models = (*catalog.MODELS.values(), *catalog.listings())
            found = tuple(
                model.name
                for model in models
                if model.kind == "module" and str(number) in re.findall(r"\d+", model.title)
            )
            if found:
                raise OtherModel(
                    f"this is a module {number}, firmware {state.firmware}, not a {own}", session.model, found
                )
            state.calls_itself = str(number)
        return f"module {number}, firmware {state.firmware}, address {address}"

    async def refresh(self) -> None:
        """What limits and moves reckon with, of every axis."""
        rows = [row for axis in self._state.axes for row in (axis.max_speed, axis.max_acceleration)]
        async with self._link.calls() as calls:
            await calls.ask_many(rows)

    @property
    def shortcomings(self) -> tuple[str, ...]:
        told = [DEPTH]
        if self._state.calls_itself:
            told.append(f"it calls itself {self._state.calls_itself}: its parameters may mean something else")
        if names := ", ".join(f"{row.name} ({row.alias})" for row in self._state.lacking.rows):
            told.append(f"its firmware {self._state.firmware} does not have {names}")
        return tuple(told)

    def only_reads(self, frame: bytes) -> bool:
        return is_retriable(frame)

    async def let_go(self) -> None:
        await self._tasks.end()
