"""Which chip answers, by VERSION."""

from __future__ import annotations

from ...errors import OtherModel, WrongState
from ..core.background_tasks import BackgroundTasks
from ..core.capabilities import Identity
from ..core.register_io import Snapshot
from ..core.register_link import RegisterLink
from ..core.session import Session
from ..core.unread_registers import NOTHING, on_board
from .identity import VERSIONS, models_of
from .memory import ChipMemory
from .reader import ChipReader


class ChipIdentity(Identity):
    """Tells one model from all others; `tasks` are the driver's own, which end when it is let go."""

    def __init__(
        self, session: Session, link: RegisterLink, memory: ChipMemory, reader: ChipReader, tasks: BackgroundTasks
    ) -> None:
        self._session = session
        self._link = link
        self._memory = memory
        self._reader = reader
        self._tasks = tasks

    async def probe(self) -> str:
        where = await on_board(self._link)
        inputs, gconf_row = self._memory.chip.inputs, self._memory.chip.gconf
        async with self._link.turn() as turn:
            word, gconf = await self._link.io(turn).read_many((inputs, gconf_row))
        title, model = self._session.family.title, self._session.model
        if word == gconf and word in NOTHING:
            raise WrongState(
                f"no {title} answers here: all bits read {word & 1}", "check power, wiring and chip select"
            )
        version = inputs.unpack(word)["VERSION"]
        others = models_of(version)
        if others and model not in others:
            # A TMC5031 and a TMC5062 show what another family's chip may show there by chance.
            other = await self._found()
            foreign = bool(other) and not set(other) <= VERSIONS.keys()
            seems = "" if foreign else f", which is that of a {' or '.join(model.upper() for model in others)}"
            raise OtherModel(
                f"this is no {title}: VERSION reads {version:#04x}{seems}", model, other or others, foreign=foreign
            )
        if version in (0, 0xFF) or not others:
            other = await self._found()
            if other or version in (0, 0xFF):
                raise OtherModel(f"this is no {title}: VERSION reads {version:#04x}", model, other, foreign=True)
        return f"a {title} answers, version {version:#04x}{where}"

    async def refresh(self) -> None:
        remembered = (*self._memory.chip.remembered, *self._memory.chip.settings)
        async with self._link.turn() as turn:
            io = self._link.io(turn)
            self._memory.saw(Snapshot(remembered, await io.read_many(remembered)))
            await self._reader.poll(io, [axis.index for axis in self._session.axes], remembered)

    def only_reads(self, frame: bytes) -> bool:
        return self._link.access.is_read(frame)

    async def let_go(self) -> None:
        await self._tasks.end()

    async def _found(self) -> tuple[str, ...]:
        return await self._session.models_found(self._link.access)
