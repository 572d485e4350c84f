"""What can stand in the datagram of the driver chain: primary signals, and the drivers we know.

Source: DS-TMC428 Tables 11-1 and 11-2.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from types import MappingProxyType

from .ram_words import whole_number

CODE_MAX = 0x1F
CUSTOM = "custom"


class Signal(IntEnum):
    """Primary signals of one motor by their 5-bit code."""

    DAC_A_0 = 0x00
    DAC_A_1 = 0x01
    DAC_A_2 = 0x02
    DAC_A_3 = 0x03
    DAC_A_4 = 0x04
    DAC_A_5 = 0x05
    PH_A = 0x06
    FD_A = 0x07
    DAC_B_0 = 0x08
    DAC_B_1 = 0x09
    DAC_B_2 = 0x0A
    DAC_B_3 = 0x0B
    DAC_B_4 = 0x0C
    DAC_B_5 = 0x0D
    PH_B = 0x0E
    FD_B = 0x0F
    Zero = 0x10
    One = 0x11
    Direction = 0x12
    Step = 0x13


_CODES_BY_NAME = {signal.name.casefold(): int(signal) for signal in Signal}
_CODES_BY_NAME |= {f"unused_{code:02x}": code for code in range(len(Signal), CODE_MAX + 1)}


def is_unused(code: int) -> bool:
    """Whether the code means no signal: 0x14..0x1F, for which the chip sends 1."""
    return code >= len(Signal)


def signal_name(code: int) -> str:
    """The data sheet's name of a code 0..31; "unused_14".."unused_1F" for those without one."""
    checked = whole_number("signal code", code, 0, CODE_MAX)
    return f"unused_{checked:02X}" if is_unused(checked) else Signal(checked).name


def signal_code(signal: str | int) -> int:
    """The 5-bit code of a signal given by name (any case) or number, also "0x10" and "$10".

    Raises ValueError for an unknown name, which it answers with the known ones, and for a number
    outside 0..31.
    """
    if not isinstance(signal, str):
        return whole_number("signal code", signal, 0, CODE_MAX)
    text = signal.strip().casefold()
    if text in _CODES_BY_NAME:
        return _CODES_BY_NAME[text]
    number = re.fullmatch(r"(?:\$|0x)([0-9a-f]{1,4})|([0-9]{1,4})", text)
    if number is None:
        known = ", ".join(known.name for known in Signal)
        raise ValueError(f"no signal is called {signal!r}; known: {known}, or a code 0..31")
    code = int(number[1], 16) if number[1] else int(number[2])
    return whole_number("signal code", code, 0, CODE_MAX)


@dataclass(frozen=True, slots=True)
class KnownDriver:
    """A driver whose datagram we know: `plain` and `fast_decay` are its signals, first bit sent first."""

    names: tuple[str, ...]
    bit_names: tuple[str, ...]
    plain: tuple[Signal, ...]
    fast_decay: tuple[Signal, ...]


def _tmc236_bits(mixed_a: Signal, mixed_b: Signal) -> tuple[Signal, ...]:
    coil_a = (mixed_a, Signal.DAC_A_5, Signal.DAC_A_4, Signal.DAC_A_3, Signal.DAC_A_2, Signal.PH_A)
    coil_b = (mixed_b, Signal.DAC_B_5, Signal.DAC_B_4, Signal.DAC_B_3, Signal.DAC_B_2, Signal.PH_B)
    return coil_a + coil_b


TMC236_FAMILY = KnownDriver(
    # Four drivers, one interface: 12 bits, of each DAC the upper four (DS-TMC428 11.2).
    names=("tmc236", "tmc239", "tmc246", "tmc249"),
    bit_names=("MDA", "CA3", "CA2", "CA1", "CA0", "PHA", "MDB", "CB3", "CB2", "CB1", "CB0", "PHB"),
    plain=_tmc236_bits(Signal.Zero, Signal.Zero),
    fast_decay=_tmc236_bits(Signal.FD_A, Signal.FD_B),
)


def _tmc26x_bits() -> tuple[Signal, ...]:
    coil_a = (Signal.PH_A, *(Signal(Signal.DAC_A_0 + bit) for bit in range(5, -1, -1)), Signal.Zero, Signal.Zero)
    coil_b = (Signal.PH_B, *(Signal(Signal.DAC_B_0 + bit) for bit in range(5, -1, -1)), Signal.Zero, Signal.Zero)
    return (Signal.Zero, Signal.Zero, *coil_a, *coil_b)


TMC26X_FAMILY = KnownDriver(
    # Told currents (DRVCONF.SDOFF): 00, then polarity and eight bits of each coil, of which six are the chip's DAC
    # (DS-TMC2660 6; the order is inferred from the driver's register, no sheet of the chip lists it).
    names=("tmc260", "tmc261", "tmc262", "tmc2660"),
    bit_names=(
        "0", "0", "PHA", "CA7", "CA6", "CA5", "CA4", "CA3", "CA2", "CA1", "CA0",
        "PHB", "CB7", "CB6", "CB5", "CB4", "CB3", "CB2", "CB1", "CB0",
    ),
    plain=_tmc26x_bits(),
    fast_decay=_tmc26x_bits(),
)  # fmt: skip

KNOWN_DRIVERS: Mapping[str, KnownDriver] = MappingProxyType(
    {name: family for family in (TMC236_FAMILY, TMC26X_FAMILY) for name in family.names}
)
