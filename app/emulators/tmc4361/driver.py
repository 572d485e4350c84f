"""The motor driver behind cover datagrams: the registers of a TMC26x, and its answers.

Its words are kept and told, but change nothing: the bridges' current is set by the current scale alone.
"""

from __future__ import annotations

BITS = 20
_NAMES = {0b00: "DRVCTRL", 0b100: "CHOPCONF", 0b101: "SMARTEN", 0b110: "SGCSCONF", 0b111: "DRVCONF"}


class Tmc26x:
    """Datagrams of 20 bits; an answer has eight flags and, by DRVCONF.RDSEL, ten bits of something."""

    def __init__(self) -> None:
        self.words: dict[str, int] = {}

    def exchange(self, datagram: int, flags: int, mscnt: int, load: int) -> int:
        """Take the last 20 bits of `datagram`; the answer in 20 bits.

        `flags` are STATUS 31:24, `mscnt` the place in the electrical turn (0..1023), `load` the StallGuard2 value.
        """
        datagram &= (1 << BITS) - 1
        kind = datagram >> 17
        name = _NAMES.get(kind, "DRVCTRL") if kind >= 0b100 else "DRVCTRL"
        self.words[name] = datagram
        selected = self.words.get("DRVCONF", 0) >> 4 & 3
        shown = {0: mscnt & 0x3FF, 1: load & 0x3FF}.get(selected, (load >> 5 & 0x1F) << 5 | 0x1F)
        return shown << 10 | flags & 0xFF
