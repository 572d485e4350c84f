"""The board's microcontroller as master of the chip's SPI."""

from __future__ import annotations

from ...links import datagram40
from ...links.port import Wire
from ...registers.model import RegisterTable

NOTHING = 0
"""What an SPI input reads while no chip drives it. Nobody says; decided here."""


class ChipRegisters:
    """Registers of a chip with 40-bit datagrams, the way the board's firmware reaches them.

    A read is the same datagram twice, so a register that reading clears is cleared twice: what comes up between the
    two is lost. What can only be written is answered from the firmware's memory of it.
    """

    def __init__(self, chip: Wire, table: RegisterTable) -> None:
        self._chip = chip
        self._resets: dict[int, int] = dict.fromkeys(range(datagram40.ADDRESS_MAX + 1), 0)
        for row in table:
            if row.access.readable:
                self._resets.pop(row.address, None)
        for row in table:
            if row.address in self._resets and row.reset:
                self._resets[row.address] = row.reset
        self._remembered = dict(self._resets)
        writable = {
            address: [row for row in table.meanings(address) if row.access.writable]
            for address in range(datagram40.ADDRESS_MAX + 1)
        }
        self.writable = tuple(address for address, rows in writable.items() if rows)
        """Addresses that can be written."""
        self.zeroed = tuple(
            address for address, rows in writable.items() if rows and not any(row.reset for row in rows)
        )
        """Those of them that come up as zero."""
        self.at_s = 0.0
        """The chip's time at which the next access takes place [s]."""

    def forget(self) -> None:
        """The chip was reset: what can only be written is as after power-on."""
        self._remembered = dict(self._resets)

    def read(self, address: int) -> int:
        """The word, unsigned; of an address beyond 7 bits the upper bits are ignored."""
        address &= datagram40.ADDRESS_MAX
        if address in self._remembered:
            return self._remembered[address]
        frame = datagram40.read(address)
        self._exchange(frame)
        return int.from_bytes(self._exchange(frame)[1:], "big")

    def signed(self, address: int) -> int:
        """The same as a signed number."""
        word = self.read(address)
        return word - (1 << 32) if word >> 31 else word

    def write(self, address: int, value: int) -> None:
        """Write the lower 32 bits of `value`."""
        address, word = address & datagram40.ADDRESS_MAX, value & datagram40.DATA_MASK
        self._exchange(datagram40.write(address, word))
        if address in self._remembered:
            self._remembered[address] = word

    def change(self, address: int, mask: int, bits: int) -> None:
        """Read, replace the bits of `mask`, write."""
        self.write(address, self.read(address) & ~mask | bits)

    def _exchange(self, frame: bytes) -> bytes:
        try:
            return self._chip.exchange(frame, self.at_s)
        except (TimeoutError, ConnectionError):
            return bytes((NOTHING,)) * datagram40.FRAME_BYTES
