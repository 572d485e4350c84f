"""The driver chain of the TMC428: from a list of drivers to the configuration RAM.

Source: DS-TMC428 chapter 11. Decoding and frequencies live in the modules beside this one and are handed
on from here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .decode import DecodedChain, Finding, decode_chain
from .frequencies import ChainFrequencies, chain_frequencies
from .model import DRIVERS_MAX, NEXT_MOTOR, STATUS_BITS, ChainBit, DriverSpec
from .ram_words import AREA_CHAIN, CELLS, pack_cells, write_datagrams
from .signals import KNOWN_DRIVERS, Signal, is_unused, signal_code, signal_name

__all__ = [
    "KNOWN_DRIVERS",
    "Chain",
    "ChainBit",
    "ChainFrequencies",
    "DecodedChain",
    "DriverSpec",
    "Finding",
    "Signal",
    "build_chain",
    "chain_frequencies",
    "decode_chain",
    "signal_code",
    "signal_name",
]


@dataclass(frozen=True, slots=True)
class Chain:
    """A driver chain, ready for the chip.

    `ram_cells` are all 64 cells of 6 bits (0 after the last bit), `ram_words` the same as 32
    register words of 24 bits, chain_conf_00..31. `datagrams` are the 32-bit writes as far as the
    chain reaches: the cells after them are never read. `lsmd` goes to the global parameter register.
    """

    drivers: tuple[DriverSpec, ...]
    bits: tuple[ChainBit, ...]
    ram_cells: tuple[int, ...]
    ram_words: tuple[int, ...]
    datagrams: tuple[int, ...]
    lsmd: int
    length_bits: int
    warnings: tuple[str, ...]


def build_chain(drivers: Sequence[str | DriverSpec | Mapping[str, object]]) -> Chain:
    """The RAM contents for `drivers`, in the order in which their bits are sent: motor 1 first.

    A driver is a known name (tmc236, tmc239, tmc246, tmc249), a `DriverSpec`, or a mapping with its
    keys: {"driver": "tmc236", "fast_decay": True}, {"driver": "custom", "signals": ["Zero", 5]}.

    Raises ValueError for none or more than three drivers, more than 64 bits in all, an unknown
    driver or signal.
    """
    if not 1 <= len(drivers) <= DRIVERS_MAX:
        raise ValueError(f"a chain has 1..{DRIVERS_MAX} drivers, not {len(drivers)}")
    specs = tuple(DriverSpec.of(item) for item in drivers)
    resolved = [spec.resolve() for spec in specs]
    length = sum(len(driver.codes) for driver in resolved)
    if length > CELLS:
        raise ValueError(f"the chain has {length} bits, the RAM holds {CELLS} cells")
    bits: list[ChainBit] = []
    for motor, driver in enumerate(resolved):
        for index, (code, bit_name) in enumerate(zip(driver.codes, driver.bit_names, strict=True)):
            last = index == len(driver.codes) - 1
            address = len(bits)
            bits.append(
                ChainBit(
                    position=address,
                    motor=motor,
                    signal=signal_name(code),
                    code=code,
                    next_motor=last,
                    ram_address=address,
                    ram_data=code | NEXT_MOTOR if last else code,
                    bit_name=bit_name,
                )
            )
    cells = tuple(bit.ram_data for bit in bits)
    all_cells = cells + (0,) * (CELLS - length)
    return Chain(
        drivers=specs,
        bits=tuple(bits),
        ram_cells=all_cells,
        ram_words=pack_cells(all_cells),
        datagrams=write_datagrams(AREA_CHAIN, pack_cells(cells)),
        lsmd=len(specs) - 1,
        length_bits=length,
        warnings=tuple(_warnings(bits)),
    )


def _warnings(bits: Sequence[ChainBit]) -> list[str]:
    found: list[str] = []
    unused = sorted({bit.code for bit in bits if is_unused(bit.code)})
    if unused:
        codes = ", ".join(f"{code:#04x}" for code in unused)
        found.append(f"signal code {codes} is unused: this chip sends 1, a later one may not; use One (0x11)")
    if len(bits) > STATUS_BITS:
        found.append(f"of {len(bits)} bits that the drivers send back, only the last {STATUS_BITS} can be read")
    return found
