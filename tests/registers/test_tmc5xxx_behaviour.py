"""What the emulated TMC5xxx do not act on is told at rows and fields that there are."""

from __future__ import annotations

from app.registers.tmc5xxx.behaviour import FIELDS, REGISTERS
from app.registers.tmc5xxx.table import TABLES


def test_each_entry_names_something_that_can_be_written() -> None:
    rows = {(model, row.name): row for model, table in TABLES.items() for row in table if row.access.writable}
    for name in (*REGISTERS, *FIELDS):
        assert any(row_name == name for _, row_name in rows), name
    fields = {(name, part.name) for (_, name), row in rows.items() for part in row.fields}
    for name, reasons in FIELDS.items():
        assert {(name, field) for field in reasons} <= fields


def test_rows_and_fields_tell_it() -> None:
    assert TABLES["tmc5240"].get("VDCMIN", 0).behaviour
    assert not TABLES["tmc5160"].get("VDCMIN", 0).behaviour
    chopconf = TABLES["tmc5062"].get("CHOPCONF", 1)
    silent = {part.name for part in chopconf.fields if not part.behaviour}
    assert silent == {
        "toff",
        "tfd_2_0",
        "fd3",
        "offset",
        "chm",
        "tbl",
        "vsense",
        "vhighfs",
        "vhighchm",
        "mres",
        "intpol16",
    }
    for table in TABLES.values():
        for row in table:
            for part in (row, *row.fields):
                assert not part.behaviour.endswith(".")
