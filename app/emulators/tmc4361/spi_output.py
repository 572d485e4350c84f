"""The datagram that the SPI output sends on its own, by spi_output_format, as an SPI slave behind it takes it.

Formats and what they carry are those of STEPPYR; the TMC23x and TMC24x have the twelve bits of DS-TMC428 Table 11-2.
What the sources leave open is read like this:

- a DAC's datagram is its command (DAC_CMD_LENGTH bits of DAC_ADDR) and behind it the value, its highest bit first,
  filled up with 0 to COVER_DATA_LENGTH: a full amplitude is full scale whatever resolution the DAC has;
- a value mapped to the full amplitude is 256 for no current, of nine bits; one with a phase bit has eight;
- without a length a DAC's datagram is as long as command and value.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

MAPPED, PHASE_POSITIVE, PHASE_NEGATIVE, SCALE, CURRENTS, DAC_SCALE = range(1, 7)
TMC23X, TMC24X, TMC26X = 8, 9, 10
DACS = frozenset((MAPPED, PHASE_POSITIVE, PHASE_NEGATIVE, DAC_SCALE))
PHASES = frozenset((PHASE_POSITIVE, PHASE_NEGATIVE))
NAMES = {
    MAPPED: "SPI DAC, values of full amplitude",
    PHASE_POSITIVE: "SPI DAC, absolute values, phase 0 is positive",
    PHASE_NEGATIVE: "SPI DAC, absolute values, phase 0 is negative",
    SCALE: "current scale",
    CURRENTS: "both currents",
    DAC_SCALE: "SPI DAC, current scale",
    TMC23X: "TMC23x",
    TMC24X: "TMC24x",
    TMC26X: "TMC26x, currents",
}
SPI_OUT_CONF, DAC_ADDR = 0x04, 0x1D
_MIXED_ALWAYS, _MIXED_MOVING, _MIXED_FALLING = 3, 2, 1


@dataclass(frozen=True, slots=True)
class Sent:
    """Datagrams as they go out, one after another, as bits; and the phases at STPOUT and DIROUT, where those are."""

    form: str
    datagrams: tuple[str, ...]
    phases: tuple[bool, bool] | None = None


def sent(word: Callable[[int], int], a: int, b: int, scale: int, *, moving: bool, falling: bool) -> Sent | None:
    """What goes out for scaled currents `a`, `b` (-256..255) and a scale 0..255; None where nothing goes out by itself.

    `word` gives registers by address.
    """
    conf = word(SPI_OUT_CONF)
    form = conf & 15
    name = NAMES.get(form)
    if name is None:
        return None
    if form in (TMC23X, TMC24X):
        mixed = conf >> 4 & 3
        on = mixed == _MIXED_ALWAYS or (mixed == _MIXED_MOVING and moving) or (mixed == _MIXED_FALLING and falling)
        return Sent(name, (_coil(a, mixed=on) + _coil(b, mixed=on),))
    if form == TMC26X:
        return Sent(name, (f"00{a < 0:b}{min(abs(a), 255):08b}{b < 0:b}{min(abs(b), 255):08b}",))
    if form == CURRENTS:
        return Sent(name, (_filled(f"{a & 0x1FF:09b}{b & 0x1FF:09b}", conf),))
    if form == SCALE:
        return Sent(name, (_filled(f"{scale:08b}", conf),))
    commands = tuple(_command(conf, word(DAC_ADDR) >> lsb & 0xFFFF) for lsb in (0, 16))
    if form == DAC_SCALE:
        return Sent(name, (_filled(f"{commands[0]}{scale:08b}", conf),))
    values = [
        f"{min(max(each + 256, 0), 511):09b}" if form == MAPPED else f"{min(abs(each), 255):08b}" for each in (a, b)
    ]
    datagrams = tuple(_filled(command + value, conf) for command, value in zip(commands, values, strict=True))
    return Sent(name, datagrams, None if form == MAPPED else phases(form, a, b))


def phases(form: int, a: int, b: int) -> tuple[bool, bool]:
    """The levels at STPOUT and DIROUT that tell which way the currents of A and B go."""
    return ((a < 0) == (form == PHASE_POSITIVE), (b < 0) == (form == PHASE_POSITIVE))


def _command(conf: int, address: int) -> str:
    length = conf >> 7 & 0x1F
    return f"{address & (1 << length) - 1:0{length}b}" if length else ""


def _filled(bits: str, conf: int) -> str:
    length = min(conf >> 13 & 0x7F, 64)
    return bits.ljust(length, "0")[:length] if length else bits


def _coil(current: int, *, mixed: bool) -> str:
    """Mixed decay, the upper four bits of the current, and its phase."""
    return f"{mixed:b}{min(abs(current), 255) >> 4:04b}{current < 0:b}"
