"""The chip's end of the single-wire UART: whole datagrams in, answers out.

A datagram with a wrong CRC is ignored (INFERRED: no source tells), as is one for another node. IFCNT counts accepted
writes; reading it changes nothing.
"""

from __future__ import annotations

from ...links.datagram_uart import SYNC, WRITE_BIT, UartForm, crc8
from .registers import Chip

NODECONF = 0x03


class UartEnd:
    """Sync nibble, node, register, data, CRC."""

    def __init__(self, chip: Chip) -> None:
        self._chip = chip

    @property
    def node(self) -> int | None:
        """Address now: NODECONF, one more with NEXTADDR high; None: the chip has none (TMC5062) or no UART."""
        chip = self._chip
        if chip.kind.uart != "node":
            return None
        return (chip.held(NODECONF) & 0xFF) + chip.node_pin & 0xFF

    @property
    def reply_delay_bits(self) -> int:
        """SENDDELAY: 0 and 1 wait 8 bit times, 2 and 3 three times as long, and so on to 15 times."""
        code = self._chip.held(NODECONF) >> self._chip.kind.delay_bit & 15
        return 8 * (code | 1)

    def answer(self, datagram: bytes) -> bytes:
        """Obey one datagram; b"" where no answer is due."""
        chip = self._chip
        if not chip.kind.uart or len(datagram) < 3 or datagram[0] & 0xF != SYNC or crc8(datagram[:-1]) != datagram[-1]:
            return b""
        body = datagram[1:-1]
        form = UartForm(None)
        if chip.kind.uart == "node":
            if body[0] != self.node:
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
