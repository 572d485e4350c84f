"""What answers cover datagrams: a TMC26x, or where the currents are wired to the motor one that keeps words alone."""

from __future__ import annotations

from .feedback.behind import NAMES

BITS = 20
STATUS_FLAGS = ("SG", "OT", "OTPW", "S2GA", "S2GB", "OLA", "OLB", "STST")
"""STATUS 31:24 with a TMC26x behind, the lowest first."""
TMC24X_FORMS = (8, 9)
"""spi_output_format of the TMC23x and TMC24x."""
TMC24X_PLACES = (5, 7, 6, 0, 1, 2, 3, 4)
"""Where UV, OT, OTPW, OCA, OCB, OLA, OLB and OCHS, in the order of STATUS 31:24, are in their answer."""


def bits_of(spi_out_conf: int) -> int:
    """How long a datagram to the driver is, as the kind of driver has it where no length is told."""
    form = spi_out_conf & 15
    return min(spi_out_conf >> 13 & 0x7F, 64) or (12 if form in TMC24X_FORMS else 40 if form in (12, 13) else BITS)


def tmc24x_answer(flags: int, load: int) -> int:
    """What a TMC23x or TMC24x answers: `flags` as STATUS 31:24 has them without a stall, `load` 0..7."""
    told = sum((flags >> bit & 1) << place for bit, place in enumerate(TMC24X_PLACES))
    return load << 9 | 1 << 8 | told


class KeptWords:
    """The words of a driver whose currents are wired: kept and told, without effect.

    Datagrams of 20 bits; an answer has eight flags and, by DRVCONF.RDSEL, ten bits of something.
    """

    def __init__(self) -> None:
        self.words: dict[str, int] = {}

    def exchange(self, datagram: int, flags: int, mscnt: int, load: int) -> int:
        """Take the last 20 bits of `datagram`; the answer in 20 bits.

        `flags` are STATUS 31:24, `mscnt` the place in the electrical turn (0..1023), `load` the StallGuard2 value.
        """
        datagram &= (1 << BITS) - 1
        kind = datagram >> 17
        name = NAMES.get(kind, "DRVCTRL") if kind >= 0b100 else "DRVCTRL"
        self.words[name] = datagram
        selected = self.words.get("DRVCONF", 0) >> 4 & 3
        shown = {0: mscnt & 0x3FF, 1: load & 0x3FF}.get(selected, (load >> 5 & 0x1F) << 5 | 0x1F)
        return shown << 10 | flags & 0xFF
