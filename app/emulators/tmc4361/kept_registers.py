"""What answers cover datagrams of 40 bits where the chip's currents are wired to the motor: a TMC2130's registers,
which are kept and told, without effect, and its status, which is that of the bridges.

Its DRV_STATUS has the flags in the order of STATUS 31:24 (DS-TMC5130 6.5.4). An answer belongs to the datagram before.
"""

from __future__ import annotations

from collections.abc import Callable

from ...links.datagram40 import ADDRESS_MAX, WRITE_BIT
from ...registers.catalog import MODELS
from ...registers.tmcdrivers import tmc2130

BITS = 40
FORMS = (12, 13)
"""spi_output_format of a TMC2130."""
_GSTAT, _DRV_STATUS, _MSCNT = 0x01, 0x6F, 0x6A
_RESET, _ERROR, _STALL, _STANDS = 1 << 0, 1 << 1, 1 << 2, 1 << 3
"""Of the status byte; the first two are GSTAT's too."""
_SG, _OFF, _STST = 1 << 0, 1 << 1 | 1 << 3 | 1 << 4, 1 << 7
"""Of the flags: a stall, what switches the bridges off (OT, S2GA, S2GB), standstill."""


class KeptRegisters:
    """A TMC2130 that has just been switched on. What it is told is kept; what it tells is what it is given."""

    def __init__(self) -> None:
        table = MODELS["tmc2130"].table
        self.words = {row.address: row.reset or 0 for row in table if row.access.writable}
        self._masks = {row.address: row.write_mask for row in table if row.access.writable}
        self._readable = {row.address for row in table if row.access.readable}
        self._names = {row.address: row.name for row in table if row.access.writable}
        self._gstat = _RESET
        self._told = 0

    def exchange(self, datagram: int, flags: int, mscnt: int, load: int) -> int:
        """Take 40 bits; the answer to them. `flags` are STATUS 31:24, `load` the StallGuard2 value."""
        failed = bool(flags & _OFF)
        self._gstat |= _ERROR if failed else 0
        status = self._gstat & _RESET
        status |= (_ERROR if failed else 0) | (_STALL if flags & _SG else 0) | (_STANDS if flags & _STST else 0)
        answer = status << 32 | self._told
        first, data = datagram >> 32, datagram & 0xFFFF_FFFF
        address = first & ADDRESS_MAX
        if first & WRITE_BIT:
            if address in self._masks:
                self.words[address] = data & self._masks[address]
            self._told = data
            return answer
        special: dict[int, Callable[[], int]] = {
            _GSTAT: self._take_gstat,
            _DRV_STATUS: lambda: (flags & 0xFF) << 24 | load & 0x3FF,
            _MSCNT: lambda: mscnt & 0x3FF,
            tmc2130.VERSION_ADDRESS: lambda: tmc2130.VERSION << 24,
        }
        read = special.get(address)
        self._told = read() if read else self.words.get(address, 0) if address in self._readable else 0
        return answer

    @property
    def named(self) -> dict[str, int]:
        """What it was told, by name."""
        return {self._names[address]: word for address, word in self.words.items()}

    def _take_gstat(self) -> int:
        gstat, self._gstat = self._gstat, 0
        return gstat
