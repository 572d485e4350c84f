"""From the configuration RAM back to a readable table of the driver chain, whatever the RAM holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from .model import DRIVERS_MAX, NEXT_MOTOR, STATUS_BITS, ChainBit, DriverSpec
from .ram_words import CELLS, WORDS, unpack_words, whole_number
from .signals import CODE_MAX, CUSTOM, KNOWN_DRIVERS, is_unused, signal_name

LSMD_MAX = 3

FindingKind = Literal["endless", "few_nxm", "over_64_bits", "unused_codes", "lsmd_not_allowed", "status_cut"]


@dataclass(frozen=True, slots=True)
class Finding:
    """Something to know about a chain: `kind` for code, `text` for people, `positions` of the bits meant."""

    kind: FindingKind
    text: str
    positions: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class DecodedChain:
    """The chain that a RAM describes, together with LSMD.

    `bits` are the bits of one pass through the RAM, up to the NxM that ends the datagram or all 64.
    `drivers` are the drivers so far recognised, such that `build_chain(drivers)` gives these bits
    again: a known one is named after the first of its family (RAM does not tell tmc236 from
    tmc249), any other is "custom". Bits that no NxM closes belong to no driver.

    `length_bits` is None for a datagram that never ends, and above 64 where the RAM has NxM bits
    but fewer than drivers.
    """

    bits: tuple[ChainBit, ...]
    drivers: tuple[DriverSpec, ...]
    lsmd: int
    length_bits: int | None
    findings: tuple[Finding, ...]


def decode_chain(ram_words: Sequence[int], lsmd: int) -> DecodedChain:
    """Read the 32 register words chain_conf_00..31 (24 bits, any noise) with `lsmd` 0..3.

    Fewer NxM bits than drivers: the sheet does not say what follows. We take it that the cell
    address runs on from 63 to 0 while the motor count stands, so that the datagram is more than 64
    bits long; a finding says so. Source: DS-TMC428 chapters 10 and 11.

    Raises ValueError unless there are 32 words of 24 bits and LSMD is 0..3 (3 is not allowed by
    Table 9-2, but a register can hold it, so it is a finding).
    """
    if len(ram_words) != WORDS:
        raise ValueError(f"a driver chain has {WORDS} RAM words, these are {len(ram_words)}")
    drivers_expected = whole_number("lsmd", lsmd, 0, LSMD_MAX) + 1
    cells = unpack_words(ram_words)
    ends = [address for address, cell in enumerate(cells) if cell & NEXT_MOTOR][:drivers_expected]
    complete = len(ends) == drivers_expected
    sent = cells[: ends[-1] + 1] if complete else cells
    drivers, bit_names = _recognised(sent, ends)
    bits = _bits(sent, bit_names)
    length = len(sent) if complete else _wrapped_length(ends, drivers_expected)
    return DecodedChain(
        bits=bits,
        drivers=drivers,
        lsmd=int(lsmd),
        length_bits=length,
        findings=tuple(_findings(bits, len(ends), drivers_expected, length)),
    )


def _wrapped_length(ends: Sequence[int], drivers: int) -> int | None:
    if not ends:
        return None
    passes, last = divmod(drivers - 1, len(ends))
    return passes * CELLS + ends[last] + 1


def _recognised(cells: Sequence[int], ends: Sequence[int]) -> tuple[tuple[DriverSpec, ...], list[str]]:
    specs: list[DriverSpec] = []
    bit_names: list[str] = []
    start = 0
    for end in ends:
        codes = tuple(cell & CODE_MAX for cell in cells[start : end + 1])
        spec, names = _recognise(codes)
        specs.append(spec)
        bit_names += names
        start = end + 1
    return tuple(specs), bit_names + [""] * (len(cells) - start)


def _recognise(codes: tuple[int, ...]) -> tuple[DriverSpec, tuple[str, ...]]:
    for name, known in KNOWN_DRIVERS.items():
        if codes in (known.plain, known.fast_decay):
            # where both are the same the chain says nothing of fast decay
            return DriverSpec(name, fast_decay=codes != known.plain), known.bit_names
    return DriverSpec(CUSTOM, signals=tuple(signal_name(code) for code in codes)), ("",) * len(codes)


def _bits(cells: Sequence[int], bit_names: Sequence[str]) -> tuple[ChainBit, ...]:
    bits: list[ChainBit] = []
    motor = 0
    for address, (cell, bit_name) in enumerate(zip(cells, bit_names, strict=True)):
        code, ends_motor = cell & CODE_MAX, bool(cell & NEXT_MOTOR)
        bits.append(ChainBit(address, motor, signal_name(code), code, ends_motor, address, cell, bit_name))
        motor += ends_motor
    return tuple(bits)


def _findings(bits: Sequence[ChainBit], nxm: int, drivers: int, length: int | None) -> list[Finding]:
    found: list[Finding] = []

    def find(kind: FindingKind, text: str, positions: tuple[int, ...] = ()) -> None:
        found.append(Finding(kind, text, positions))

    if drivers > DRIVERS_MAX:
        find("lsmd_not_allowed", f"LSMD is {drivers - 1}; a chain has at most {DRIVERS_MAX} drivers")
    if length is None:
        find("endless", "no NxM bit in the RAM: the chip sends endlessly; configure the chain first")
    elif nxm < drivers:
        find("few_nxm", f"{nxm} NxM bit(s) for {drivers} drivers (LSMD {drivers - 1}): the datagram ends too late")
        find("over_64_bits", f"the chip would pass the end of the RAM and send {length} bits; {CELLS} are allowed")
    unused = tuple(bit.position for bit in bits if is_unused(bit.code))
    if unused:
        where = ", ".join(map(str, unused))
        find("unused_codes", f"unused signal codes 0x14..0x1F at position {where}: sent as 1", unused)
    if length is not None and STATUS_BITS < length <= CELLS:
        find("status_cut", f"of {length} bits that the drivers send back, only the last {STATUS_BITS} can be read")
    return found
