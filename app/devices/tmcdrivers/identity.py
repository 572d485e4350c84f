"""Which chip answers, by VERSION."""

from __future__ import annotations

from ...errors import OtherModel, WrongState
from ...links.queue import LinkQueue
from ...links.register_access import RegisterAccess, UartAccess
from ...registers.tmcdrivers.models import MODELS
from ..core.capabilities import Identity
from ..core.register_io import read_once_more
from ..core.unread_registers import NOTHING
from .reader import Reader


class DriverIdentity(Identity):
    """Tells one model from all others."""

    def __init__(self, reader: Reader) -> None:
        self._reader = reader
        self._link = reader.link
        self._session = reader.link.session

    async def probe(self) -> str:
        rows = self._reader.memory.rows
        async with self._link.turn() as turn:
            word, gconf = await self._link.io(turn).read_many((rows.inputs, rows.gconf))
        title, model = self._session.family.title, self._session.model
        if word == gconf and word in NOTHING:
            raise WrongState(f"no {title} answers here: all bits read {word & 1}", "check power, wiring and address")
        version = rows.inputs.unpack(word)["VERSION"]
        if version != self._session.family.version:
            other = await self._session.models_found(self._link.access)
            raise OtherModel(f"this is no {title}: VERSION reads {version:#04x}", model, other, foreign=True)
        return f"a {title} answers, version {version:#04x}"

    async def refresh(self) -> None:
        await self._reader.read_axis()

    def only_reads(self, frame: bytes) -> bool:
        return self._link.access.is_read(frame)

    async def let_go(self) -> None:
        """The driver does nothing on its own."""


async def found_by(queue: LinkQueue, access: RegisterAccess) -> tuple[str, ...]:
    """The driver that may be there, where something else was expected; empty where nothing speaks for one."""
    if not isinstance(access, UartAccess):
        return ()  # what stands there in other chips may look like any version
    alone = [model for model in MODELS if model.uart_alone]
    for address in dict.fromkeys(model.version_address for model in alone):
        version = await read_once_more(queue, address, access) >> 24
        found = tuple(model.name for model in alone if (model.version_address, model.version) == (address, version))
        if found:
            return found
    return ()
