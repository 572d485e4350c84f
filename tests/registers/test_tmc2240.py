"""The registers of the TMC2240 against PyTrinamic's masks; what is told of resets is a TMC5240's."""

from __future__ import annotations

from pytrinamic.ic import TMC2240

from app.registers.catalog import MODELS
from app.registers.model import Access

TABLE = MODELS["tmc2240"].table
OTHER_NAMES = {"SLAVECONF": "NODECONF", **{f"MSLUT_{n}": f"MSLUT[{n}]" for n in range(8)}}
FIELD_NAMES = {
    "FAST_STANDSTILL": "faststandstill",
    "DIAG0_PUSHPULL": "diag0_int_pushpull",
    "DIAG1_PUSHPULL": "diag1_poscomp_pushpull",
    "SLAVEADDR": "NODEADDR",
    "HSTRT_TFD210": "hstrt",
    "HEND_OFFSET": "hend",
}
NOT_OURS = {"RESERVED", "POS_NEG_EDGE"}
"""A field of two, and a bit that nobody may touch."""


def test_it_has_the_registers_that_pytrinamic_names_and_the_level_of_a_pin() -> None:
    theirs = {OTHER_NAMES.get(name, name): at for name, at in vars(TMC2240.REG).items() if name.isupper()}
    assert {row.name: row.address for row in TABLE} == {**theirs, "OUTPUT": 0x04}


def test_its_fields_lie_where_pytrinamic_has_them() -> None:
    known = {name: value for name, value in vars(TMC2240.FIELD).items() if isinstance(value, tuple)}
    assert len(known) > 130
    for name, (address, mask, shift) in known.items():
        row = TABLE.at(address)
        assert row is not None, name
        field = row.field_named(FIELD_NAMES.get(name, name))
        found = (row.mask, 0) if field is None else (field.mask, field.lsb)
        assert found == (mask, shift) or name in NOT_OURS, name


def test_all_that_can_be_written_can_be_read() -> None:
    """TMC-API, table of access."""
    assert [row.name for row in TABLE if row.access is Access.W and row.name != "OUTPUT"] == []


def test_spi_and_a_uart_lead_to_it() -> None:
    model = MODELS["tmc2240"]
    assert (model.datagram_bits, model.uart, model.version, model.version_address) == (40, "node", 0x40, 0x04)
    assert model.wires == {"emulator", "tcp", "spidev", "landungsbruecke", "uart", "cover"}
    assert not model.uart_alone
