"""The TMC2660's registers against PyTrinamic's table."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app.registers.tmcdrivers.tmc2660 import FORMAT, TABLE

pytrinamic = pytest.importorskip("pytrinamic.ic.TMC2660")
OURS = {"SG_RESULT": "SG", "SG_UPPER": "SG", "offset": "HEND", "tfd_2_0": "HSTRT", "fd3": "HDEC0", "disfdcc": "HDEC1"}


def test_addresses_are_those_of_the_makers_table() -> None:
    theirs = {name: value for name, value in vars(pytrinamic.TMC2660.REG).items() if not name.startswith("_")}
    assert {row.name: row.address for row in TABLE} == theirs


@pytest.mark.parametrize("row", list(TABLE), ids=lambda row: row.name)
def test_fields_are_where_the_makers_table_has_them(row: object) -> None:
    theirs: dict[tuple[int, str], set[tuple[int, int]]] = {}
    # a name of it is there twice, of which Python keeps one: so its text is read
    source = Path(pytrinamic.__file__).read_text(encoding="utf-8")
    for name, address, mask, shift in re.findall(r"(\w+)\s*= \(\s*(0x\w+), (0x\w+),\s*(\d+)\s*\)", source):
        theirs.setdefault((int(address, 16), name.upper()), set()).add((int(mask, 16), int(shift)))
    for part in row.fields:  # type: ignore[attr-defined]
        places = theirs[row.address, OURS.get(part.name, part.name).upper()]  # type: ignore[attr-defined]
        assert (part.mask, part.lsb) in places, part.name


@pytest.mark.parametrize(
    ("datagram", "address"), [(0x3_FFFF, 8), (0x9_1935, 12), (0xA_0000, 13), (0xD_0505, 14), (0xE_F040, 15)]
)
def test_a_register_is_told_by_its_leading_bits(datagram: int, address: int) -> None:
    assert FORMAT.address_of(datagram) == address
