"""A chip's end of the single-wire UART: whole datagrams in, answers out.

A datagram with a wrong CRC is ignored (INFERRED: no source tells), as is one for another node. IFCNT counts accepted
writes; reading it changes nothing.
"""

from __future__ import annotations

from typing import Protocol

from ...links.datagram_uart import SYNC, WRITE_BIT, UartForm, crc8


class UartChip(Protocol):
    """Registers behind a UART."""

    ifcnt: int
    """Writes that were accepted, modulo 256."""

    @property
    def has_uart(self) -> bool: ...

    @property
    def node(self) -> int | None:
        """Address now; None: the chip has none, or no UART."""
        ...

    @property
    def send_delay(self) -> int:
        """SENDDELAY as it was written."""
        ...

    def read(self, address: int) -> int:
        """The word at `address`, with all consequences."""
        ...

    def write(self, address: int, word: int) -> None:
        """Write `word`."""
        ...


class UartEnd:
    """Sync nibble, node, register, data, CRC."""

    def __init__(self, chip: UartChip) -> None:
        self._chip = chip

    @property
    def node(self) -> int | None:
        """Address now; None: the chip has none."""
        return self._chip.node

    @property
    def reply_delay_bits(self) -> int:
        """SENDDELAY: 0 and 1 wait 8 bit times, 2 and 3 three times as long, and so on to 15 times."""
        return 8 * (self._chip.send_delay | 1)

    def answer(self, datagram: bytes) -> bytes:
        """Obey one datagram; b"" where no answer is due."""
        chip = self._chip
        if not chip.has_uart or len(datagram) < 3 or datagram[0] & 0xF != SYNC or crc8(datagram[:-1]) != datagram[-1]:
            return b""
        body = datagram[1:-1]
        form, node = UartForm(None), chip.node
        if node is not None:
            if body[0] != node:
                return b""
            form, body = UartForm(0), body[1:]
        if not body:
            return b""
        address = body[0] & ~WRITE_BIT & 0xFF
        if body[0] & WRITE_BIT:
            if len(body) == 5:
                chip.ifcnt = chip.ifcnt + 1 & 0xFF
                chip.write(address, int.from_bytes(body[1:], "big"))
            return b""
        return form.reply(address, chip.read(address)) if len(body) == 1 else b""
