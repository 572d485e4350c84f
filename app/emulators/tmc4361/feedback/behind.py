"""Drivers with registers of their own behind the chip, and how each is told what the chip sends by itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from ....links.datagram40 import ADDRESS_MAX, WRITE_BIT
from ....registers.catalog import MODELS
from ...drive.drive import Drive, DriveCells
from ...drive.options import DriveOptions
from ...drive.tmc22xx import DIRECT, StepDirDriver
from ...drive.tmc26x import BITS as BITS_26X
from ...drive.tmc26x import DRVCTRL, SGCSCONF, Tmc26x
from ...drive.tmc2130 import TMC2130
from . import layout as c

BITS_2130 = 40
NAMES = {0b00: "DRVCTRL", 0b100: "CHOPCONF", 0b101: "SMARTEN", 0b110: "SGCSCONF", 0b111: "DRVCONF"}
"""Registers of a TMC26x by the first bits of a datagram."""
_SCALES = 0x1F1F
"""Of IHOLD_IRUN: both current scales."""


class DriverBehind(Protocol):
    """A driver with its motor, whose cells lie in the feedback unit's."""

    kind: int
    """As the kernel names it."""

    @property
    def drive(self) -> Drive: ...

    @property
    def takes_currents(self) -> bool:
        """Whether it is set up for coil currents, and looks at no steps."""
        ...

    @property
    def flags(self) -> int:
        """SG, OT, OTPW, S2GA, S2GB, OLA, OLB, STST, the lowest first."""
        ...

    @property
    def words(self) -> dict[str, int]:
        """What has been written, by register."""
        ...

    def reset(self) -> None:
        """As after power-on."""
        ...

    def exchange(self, datagram: int, bits: int) -> int:
        """The answer to a datagram of `bits` bits, which takes effect after it."""
        ...

    def polled(self, flags: int) -> int:
        """What POLLING_STATUS shows, with the `flags` that were polled last."""
        ...

    def told(self, scale: int, sent: tuple[int, int] | None) -> None:
        """Have the registers show what the chip has written by itself: a current scale, and coil currents or None."""
        ...


class Tmc26xBehind:
    """Datagrams of 20 bits: currents are DRVCTRL's, the scale is SGCSCONF's."""

    kind = c.TMC26X

    def __init__(self, options: DriveOptions, cells: DriveCells) -> None:
        self._chip = Tmc26x(options, cells)
        self.drive = self._chip.drive
        self._chip.step(0)

    @property
    def takes_currents(self) -> bool:
        return self._chip.takes_currents

    @property
    def flags(self) -> int:
        return self._chip.flags

    @property
    def words(self) -> dict[str, int]:
        return {NAMES[tag]: tag << 17 | word for tag, word in self._chip.words.items()}

    def reset(self) -> None:
        self._chip.reset()
        self._chip.step(0)

    def exchange(self, datagram: int, bits: int) -> int:
        del bits  # the last 20 are obeyed
        return self._chip.exchange(datagram & (1 << BITS_26X) - 1)

    def polled(self, flags: int) -> int:
        return self._chip.answer & ~0xFF | flags

    def told(self, scale: int, sent: tuple[int, int] | None) -> None:
        chip = self._chip
        if sent is not None:
            a, b = (min(abs(part), 255) | (part < 0) << 8 for part in sent)
            if chip.takes_currents:
                chip.words[DRVCTRL] = a << 9 | b
            else:  # they are its step control
                chip.write(a << 9 | b)
        if scale != chip.words[SGCSCONF] & 31:
            chip.write(SGCSCONF << 17 | chip.words[SGCSCONF] & ~31 | scale)


class Tmc2130Behind:
    """Datagrams of 40 bits: currents are XDIRECT's, the scale is IHOLD_IRUN's, both of it (a reading)."""

    kind = c.TMC2130

    def __init__(self, options: DriveOptions, cells: DriveCells) -> None:
        self._table = MODELS["tmc2130"].table
        self._chip = StepDirDriver(TMC2130, self._table, options, cells=cells)
        self.drive = self._chip.drive
        self._scales = self._table.get("IHOLD_IRUN", 0).address
        self._answer = 0
        self._chip.step(0)

    @property
    def takes_currents(self) -> bool:
        return self._chip.takes_currents

    @property
    def flags(self) -> int:
        return self._chip.drive.read("DRV_STATUS") >> 24 & 0xFF

    @property
    def words(self) -> dict[str, int]:
        return {row.name: self._chip.held(row.address) for row in self._table if row.access.writable}

    def reset(self) -> None:
        self._chip.reset()
        self._chip.step(0)
        self._answer = 0

    def exchange(self, datagram: int, bits: int) -> int:
        chip = self._chip
        answer = chip.spi_status << 32 | self._answer
        if bits < BITS_2130:  # fetches the beginning of the answer
            return answer >> BITS_2130 - bits
        first, data = datagram >> 32 & 0xFF, datagram & 0xFFFF_FFFF
        if first & WRITE_BIT:
            chip.write(first & ADDRESS_MAX, data)
            self._answer = data
        else:
            self._answer = chip.read(first)
        return answer << bits - BITS_2130 | datagram >> BITS_2130

    def polled(self, flags: int) -> int:
        return self._chip.drive.read("DRV_STATUS") & 0xFF_FFFF | flags << 24

    def told(self, scale: int, sent: tuple[int, int] | None) -> None:
        chip = self._chip
        if sent is not None:
            chip.keep(DIRECT, sent[0] & 0x1FF | (sent[1] & 0x1FF) << 16)
        held = chip.held(self._scales)
        if not chip.takes_currents and scale != held >> 8 & 31:
            chip.write(self._scales, held & ~_SCALES | scale << 8 | scale)


DRIVERS: Mapping[str, Callable[[DriveOptions, DriveCells], DriverBehind]] = {
    "tmc2660": Tmc26xBehind,
    "tmc2130": Tmc2130Behind,
}
"""Those that an emulated chip can have behind it, by the name in the catalog."""
