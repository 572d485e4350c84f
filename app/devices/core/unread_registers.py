"""Registers that cannot be read: what was written to them since the chip's reset, and what answers about them say."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ...errors import BadReply, WrongState
from ...links import evaluation_board
from ...links.register_access import BoardAccess
from ...registers.model import Register
from .changes import DONE, register_changed
from .register_file import RegisterRules, reading, written
from .register_link import RegisterLink
from .results import RegisterWritten

NOTHING = (0, 0xFFFF_FFFF)
"""What a bus reads on which nobody drives the line."""


def arrived_unread(register: Register, word: int, notes: Sequence[str]) -> RegisterWritten:
    """The answer to a write of a register that cannot be read, over a link that shows what arrived."""
    said = "; ".join(filter(None, [*notes, register.write_note, "the link has shown that it arrived"]))
    return written(reading(register, None, word), word, True, said)


def tell_table(link: RegisterLink, rules: RegisterRules, words: Iterable[tuple[Register, int]], arrived: bool) -> None:
    """The words of a microstep table went out: those that are others now are told. Raises BadReply where a word may
    have arrived otherwise."""
    session = link.session
    outcome = DONE if arrived else "not proven: it may have arrived otherwise"
    for register, word in words:
        old = rules.kept_word(register)
        rules.sent(register, word)
        if word != old:
            session.tell(
                register_changed(register, old, word, session.port.last_exchange_s, outcome, "the microstep table")
            )
    if not arrived:
        raise BadReply(session.port.name, "a word of the microstep table may have arrived otherwise", b"")


async def on_board(link: RegisterLink) -> str:
    """Where the chip is, for people. Raises WrongState where an evaluation board is expected and none answers."""
    if not isinstance(link.access, BoardAccess):
        return ""
    board = await evaluation_board.identify(link.session.queue)
    if board is None:
        raise WrongState("no evaluation board answers here", "a module has a model of its own")
    return f" on {board}"
