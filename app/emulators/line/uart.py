"""A chip with a single-wire UART as its line sees it: datagrams in, answers out after SENDDELAY."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from ...clock import Clock, ScaledClock
from ...links.datagram_uart import form_of
from .faults import LineFaults
from .framing import UartDatagrams
from .line import SEED, Line


class UartSpeaker(Protocol):
    """An emulated chip with a UART."""

    @property
    def model(self) -> str:
        """As in the catalog."""
        ...

    @property
    def clock(self) -> ScaledClock:
        """The chip's time."""
        ...

    @property
    def reply_delay_bits(self) -> int:
        """Bit times between the end of a question and the answer."""
        ...

    def uart(self, datagram: bytes, at_s: float | None = None) -> bytes:
        """The answer to a datagram at chip time `at_s` [s]; b"" for none. Raises ConnectionError, TimeoutError."""
        ...

    def catch_up(self, slice_s: float) -> bool:
        """Live on by at most `slice_s` [s] of its time; True once it is up to date."""
        ...


class UartChip:
    """A chip as a `LineModule`. Its own faults are those of its pins; the line has those of the wire."""

    def __init__(self, chip: UartSpeaker, bit_s: Callable[[], float]) -> None:
        """`bit_s` tells the time of a bit on the line [s]."""
        self.chip = chip
        self.clock = chip.clock
        self.faults = LineFaults()
        self._bit_s = bit_s

    @property
    def reply_pause_s(self) -> float:
        """SENDDELAY at the baud rate of the line, which the chip measures [s]."""
        return self.chip.reply_delay_bits * self._bit_s()

    def receive(self, frame: bytes, at_s: float | None = None) -> bytes | None:
        """The chip's answer; None where it gives none: a write, another node, a wrong CRC, no power."""
        try:
            return self.chip.uart(frame, at_s) or None
        except (TimeoutError, ConnectionError):
            return None

    def unsolicited(self, at_s: float | None = None) -> list[tuple[float, bytes]]:
        """A chip speaks only when it is asked."""
        del at_s
        return []

    def catch_up(self, slice_s: float) -> bool:
        """As the chip's."""
        return self.chip.catch_up(slice_s)


def uart_line(
    chips: Sequence[UartSpeaker],
    clock: Clock,
    *,
    nodes: Sequence[int] = (0,),
    baud: int | None = None,
    echo: bool = False,
    shared_bus: bool = False,
    seed: int = SEED,
) -> Line:
    """A single wire with these chips on it, all with datagrams of one form; `nodes` is what they are called."""

    def bit_s() -> float:
        return 1 / line.baud if line.baud else 0.0

    line = Line(
        [UartChip(chip, bit_s) for chip in chips],
        clock,
        baud=baud,
        echo=echo,
        shared_bus=shared_bus,
        addresses=nodes,
        seed=seed,
        framing=UartDatagrams(form_of(chips[0].model)),
    )
    return line
