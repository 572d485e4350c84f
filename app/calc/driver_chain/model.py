"""What a driver chain is made of: the drivers as the user names them, the bits as the chip sends them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from .ram_words import CELLS
from .signals import CUSTOM, KNOWN_DRIVERS, signal_code

NEXT_MOTOR = 0x20
"""NxM, bit 5 of a RAM cell."""
DRIVERS_MAX = 3
STATUS_BITS = 48
"""Bits sent back by the drivers that datagram_low_word and datagram_high_word hold (DS-TMC428 2.2, 9.1)."""


@dataclass(frozen=True, slots=True)
class DriverSpec:
    """One driver of the chain: a known one by name, or "custom" with its own signals.

    `signals` are names or codes, the first bit sent first; `bit_names` what the driver's own sheet
    calls these bits (for drawing). `fast_decay` lets a known driver's mixed-decay bits follow FD_A
    and FD_B instead of being 0.
    """

    driver: str
    fast_decay: bool = False
    signals: tuple[str | int, ...] | None = None
    bit_names: tuple[str, ...] | None = None

    @classmethod
    def of(cls, item: str | DriverSpec | Mapping[str, object]) -> DriverSpec:
        """A spec from a name, a spec, or a mapping with the keys of a spec.

        Raises ValueError for another type, an unknown key, or a value of the wrong kind: it comes
        from people, and whoever calls has one kind of error to translate (hence each noqa here).
        """
        if isinstance(item, DriverSpec):
            return item
        if isinstance(item, str):
            return cls(item)
        if not isinstance(item, Mapping):
            raise ValueError(f"a driver is a name or a mapping, not {item!r}")  # noqa: TRY004
        unknown = sorted(str(key) for key in item if key not in {"driver", "fast_decay", "signals", "bit_names"})
        if unknown:
            raise ValueError(f"a driver has driver, fast_decay, signals, bit_names, not {', '.join(unknown)}")
        driver = item.get("driver", CUSTOM if "signals" in item else None)
        fast_decay = item.get("fast_decay", False)
        if not isinstance(driver, str):
            raise ValueError(f"a driver's name is text, not {driver!r}")  # noqa: TRY004
        if not isinstance(fast_decay, bool):
            raise ValueError(f"fast_decay is true or false, not {fast_decay!r}")  # noqa: TRY004
        return cls(driver, fast_decay, _signals(item.get("signals")), _bit_names(item.get("bit_names")))

    def resolve(self) -> ResolvedDriver:
        """Its bits as codes and names. Raises ValueError where the spec does not make a driver."""
        name = self.driver.strip().casefold()
        known = KNOWN_DRIVERS.get(name)
        if known is None and name != CUSTOM:
            raise ValueError(f"no driver is called {self.driver!r}; known: {', '.join(KNOWN_DRIVERS)}, {CUSTOM}")
        if known is not None:
            if self.signals is not None:
                raise ValueError(f"{name} has its own signals; a driver with others is called {CUSTOM!r}")
            codes = tuple(int(signal) for signal in (known.fast_decay if self.fast_decay else known.plain))
        else:
            if not self.signals:
                raise ValueError(f"a {CUSTOM} driver needs a list of signals")
            if self.fast_decay:
                raise ValueError(f"fast_decay belongs to known drivers; a {CUSTOM} one lists FD_A and FD_B itself")
            if len(self.signals) > CELLS:
                raise ValueError(f"a driver of {len(self.signals)} bits does not fit the {CELLS} cells of the RAM")
            codes = tuple(signal_code(signal) for signal in self.signals)
        bit_names = self.bit_names or (known.bit_names if known else ("",) * len(codes))
        if len(bit_names) != len(codes):
            raise ValueError(f"{name} has {len(codes)} bits, but {len(bit_names)} bit names")
        return ResolvedDriver(name, known is not None and self.fast_decay, codes, bit_names)


@dataclass(frozen=True, slots=True)
class ResolvedDriver:
    """A driver with its signal codes (0..31) and bit names ("" where unknown), first bit first."""

    name: str
    fast_decay: bool
    codes: tuple[int, ...]
    bit_names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ChainBit:
    """One bit of the chain's datagram, the first sent at `position` 0.

    `motor` is 0..2 (SMDA), `ram_address` the cell 0..63 and `ram_data` its six bits, NxM included;
    `bit_name` is the driver's own name for the bit, "" where unknown.
    """

    position: int
    motor: int
    signal: str
    code: int
    next_motor: bool
    ram_address: int
    ram_data: int
    bit_name: str


def _signals(value: object) -> tuple[str | int, ...] | None:
    if value is None:
        return None
    if isinstance(value, str) or not isinstance(value, list | tuple):
        raise ValueError(f"signals are a list of names or codes, not {value!r}")  # noqa: TRY004
    for entry in value:
        if isinstance(entry, bool) or not isinstance(entry, str | int):
            raise ValueError(f"a signal is a name or a code, not {entry!r}")  # noqa: TRY004
    return tuple(value)


def _bit_names(value: object) -> tuple[str, ...] | None:
    if value is None:
        return None
    if isinstance(value, str) or not isinstance(value, list | tuple) or not all(isinstance(x, str) for x in value):
        raise ValueError(f"bit_names are a list of text, not {value!r}")
    return tuple(value)
