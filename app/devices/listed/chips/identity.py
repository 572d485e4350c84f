"""Which chip answers: nobody can tell for sure where only names of registers are known."""

from __future__ import annotations

from ....errors import WrongState
from ....registers.evaluation_board import ADDRESS
from ....registers.model import Register
from ...core.background_tasks import BackgroundTasks
from ...core.capabilities import Identity
from ...core.register_link import RegisterLink
from ...core.session import Session
from ...core.unread_registers import NOTHING, on_board

DEPTH = (
    "of its registers the names are known, as far as its table tells: no units, no calculators; velocities are the "
    "chip's own numbers"
)
REGISTERS_ONLY = "its table names no ramp generator: it has registers here, and no axis that could be moved"
PROBED = 2
"""How many registers are read to see that a chip answers."""


class ListedChipIdentity(Identity):
    """Asks for some registers, and for VERSION where the table has one."""

    def __init__(self, session: Session, link: RegisterLink, tasks: BackgroundTasks) -> None:
        self._session = session
        self._link = link
        self._tasks = tasks

    async def probe(self) -> str:
        session = self._session
        # A chip with an address of its own answers by itself, as a module does, and not the board that it stands on.
        asks_board = session.link.get("kind") != "emulator" and session.family.slot.module == ADDRESS
        where = await on_board(self._link) if asks_board else ""
        rows = [row for row in self._link.table if row.access.readable and not row.read_clears and not row.when]
        title = self._session.family.title
        version = next((row for row in rows if _version_field(row)), None)
        asked = [*([] if version is None else [version]), *[row for row in rows if row is not version][:PROBED]]
        if not asked:
            return f"a {title} may be there{where}: it has nothing that could be read without clearing it"
        async with self._link.turn() as turn:
            words = await self._link.io(turn).read_many(asked)
        if len(words) > 1 and len(set(words)) == 1 and words[0] == NOTHING[1]:
            raise WrongState(f"no {title} answers here: all bits read 1", "check power, wiring and chip select")
        told = "" if version is None else f", {_told(version, words[0])}"
        return f"something that can be a {title} answers{where}{told}"

    async def refresh(self) -> None:
        """Nothing is reckoned with but what a move reads anyway."""

    @property
    def shortcomings(self) -> tuple[str, ...]:
        return (DEPTH,) if self._session.axes else (DEPTH, REGISTERS_ONLY)

    def only_reads(self, frame: bytes) -> bool:
        return self._link.access.is_read(frame)

    async def let_go(self) -> None:
        await self._tasks.end()


def _version_field(row: Register) -> str:
    """The name of what tells the version there; "" where nothing does."""
    for part in (row, *row.fields):
        if part.name.casefold().rpartition("_")[2] == "version":
            return part.name
    return ""


def _told(row: Register, word: int) -> str:
    name = _version_field(row)
    part = row.field_named(name)
    return f"version {row.decode(word) if part is None else part.unpack(word):#04x}"
