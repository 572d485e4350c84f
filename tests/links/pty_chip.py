"""Chips with a UART on a real pseudo-terminal that answer by a script the test owns, and keep their registers."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

from app.links.datagram_uart import IFCNT, UartForm, crc8
from app.links.uart_line import UartPort, uart_port
from app.links.uart_session import FENCES, Echo
from tests.links.pty_module import LONG_S, Behaviour, PtyModule

XACTUAL, VMAX, XTARGET, AMAX = 0x21, 0x27, 0x2D, 0x26


class PtyChip(PtyModule):
    """Chips at `nodes`, or one without (None). `words` holds their registers by (node, register)."""

    def __init__(self, nodes: tuple[int | None, ...] = (0,), *, echo: bool = False, behave: Behaviour | None = None):
        self.nodes = nodes
        self.words: dict[tuple[int | None, int], int] = {}
        self.echo = echo
        self._plain = nodes == (None,)
        super().__init__(behave or right)

    def size_of(self, received: bytes) -> int:
        place = 1 if self._plain else 2
        if len(received) <= place:
            return 0
        return place + 6 if received[place] & 0x80 else place + 2

    def form(self, frame: bytes) -> UartForm:
        return UartForm(None if self._plain else frame[1])

    def obey(self, frame: bytes) -> bytes:
        """What the chip answers; b"" for a write, another node, a wrong CRC."""
        form = self.form(frame)
        if form.node not in self.nodes or crc8(frame[:-1]) != frame[-1]:
            return b""
        register = form.register_of(frame)
        if form.is_write(frame):
            self.words[form.node, register] = int.from_bytes(frame[-5:-1], "big")
            self.words[form.node, IFCNT] = self.words.get((form.node, IFCNT), 0) + 1 & 0xFF
            return b""
        return form.reply(register, self.words.get((form.node, register), word_of(register, form.node)))

    def refusal(self, frame: bytes) -> bytes:
        """Chips have none: they keep silent."""
        return b""

    def asked(self) -> list[bytes]:
        """The datagrams seen, without those that only keep the line in step or count writes."""
        return [frame for frame in self.seen if self.form(frame).register_of(frame) not in FENCES]


def word_of(register: int, node: int | None) -> int:
    """What a register holds that nobody has written: no two are the same, but for IFCNT."""
    return 0 if register == IFCNT else 0x8000_0000 | (node or 0) << 16 | register


def right(module: PtyModule, frame: bytes) -> bytes:
    chip = cast("PtyChip", module)
    return (frame if chip.echo else b"") + chip.obey(frame)


def but_fences(behave: Behaviour) -> Behaviour:
    """`behave` for all but readings of registers that keep a line in step, which are answered."""

    def mixed(module: PtyModule, frame: bytes) -> bytes:
        form = cast("PtyChip", module).form(frame)
        harmless = not form.is_write(frame) and form.register_of(frame) in FENCES
        return right(module, frame) if harmless else behave(module, frame)

    return mixed


@contextmanager
def pty_chip(
    nodes: tuple[int | None, ...] = (0,), *, echo: bool = False, behave: Behaviour | None = None
) -> Iterator[PtyChip]:
    chip = PtyChip(nodes, echo=echo, behave=behave)
    try:
        yield chip
    finally:
        chip.close()


def port_to(
    chip: PtyChip, node: int | None = 0, echo: Echo = "auto", timeout_s: float = LONG_S, baud: int = 115_200
) -> UartPort:
    """A port that is patient."""
    return uart_port(chip.path, UartForm(node), baud=baud, echo=echo, timeout_s=timeout_s)
