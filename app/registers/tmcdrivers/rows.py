"""What the rows of the drivers share: where a source begins, rows that several have."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from ..build import RW, Rows
from ..model import Field, Register, RegisterTable
from ..tmc5xxx import driver
from ..tmc5xxx.rows import VENDOR, sheet
from .behaviour import with_behaviour

PLACE_ROWS = (
    replace(
        driver.PLACE_ROWS[0], help="place of phase A in the microstep table now; phase B is 256 ahead", source=VENDOR
    ),
    replace(
        driver.PLACE_ROWS[1],
        source=VENDOR,
        fields=(
            Field("CUR_A", 9, "phase A: sine", signed=True, lsb=0),
            Field("CUR_B", 9, "phase B: cosine", signed=True, lsb=16),
        ),
    ),
)
"""MSCNT and MSCURACT of drivers whose phase A has the sine."""
_driver = Rows(driver.DRIVER, VENDOR)


def direct_row(name: str, part: str) -> Register:
    """0x2D: coil currents that take the place of the microstep table's; `part` begins the names of its two fields."""
    return _driver(0x2D, name, 25, RW, "currents of both coils with direct_mode, before scaling").having(
        Field(f"{part}A", 9, "coil A", signed=True, lsb=0), Field(f"{part}B", 9, "coil B", signed=True, lsb=16)
    )


def table_like(model: str, sister: str, chip: Iterable[Register], axis: Iterable[Register]) -> RegisterTable:
    """The table of a driver whose own data sheet was not at hand: the vendor's headers, and what is told of a `sister`
    with the same driver inside. `chip` are rows of the whole chip, `axis` those of its motor."""

    def row(one: Register, axis: int | None) -> Register:
        own = one.source.removeprefix(VENDOR).strip(";, ")
        try:
            told = f"as {sheet(sister, one.name, one.group)}"
        except KeyError:  # the sister's sheet tells no such register
            told = ""
        return with_behaviour(replace(one, source="; ".join(filter(None, (VENDOR, own, told))))).completed(axis)

    def rows() -> Iterator[Register]:
        placed = [*((one, None) for one in chip), *((one, 0) for one in axis)]
        for one, place in sorted(placed, key=lambda each: each[0].address):
            yield row(one, place)

    return RegisterTable(model, tuple(rows()))
