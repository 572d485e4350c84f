"""The registers of the TMC2130 against PyTrinamic's masks, and access and resets of the maker's TMC-API."""

from __future__ import annotations

from pytrinamic.ic import TMC2130

from app.registers.catalog import MODELS

TABLE = MODELS["tmc2130"].table
# Address, name, access (R-: reading clears), width, reset (-: none is told). `tmc/ic/TMC2130/TMC2130.h` of TMC-API.
WORDS = """
    00 GCONF RW 18 0x0; 01 GSTAT R- 3 -; 04 IOIN R 32 -; 10 IHOLD_IRUN W 20 0x0; 11 TPOWERDOWN W 8 0x0; 12 TSTEP R
    20 -; 13 TPWMTHRS W 20 0x0; 14 TCOOLTHRS W 20 0x0; 15 THIGH W 20 0x0; 2d XDIRECT RW 25 0x0; 33 VDCMIN W 23 0x0;
    60 MSLUT[0] W 32 0xaaaab554; 61 MSLUT[1] W 32 0x4a9554aa; 62 MSLUT[2] W 32 0x24492929; 63 MSLUT[3] W 32
    0x10104222; 64 MSLUT[4] W 32 0xfbffffff; 65 MSLUT[5] W 32 0xb5bb777d; 66 MSLUT[6] W 32 0x49295556; 67 MSLUT[7] W
    32 0x404222; 68 MSLUTSEL W 32 0xffff8056; 69 MSLUTSTART W 24 0xf70000; 6a MSCNT R 10 -; 6b MSCURACT R 25 -; 6c
    CHOPCONF RW 31 0x0; 6d COOLCONF W 25 0x0; 6e DCCTRL W 24 0x0; 6f DRV_STATUS R 32 -; 70 PWMCONF W 22 0x50480; 71
    PWM_SCALE R 8 -; 72 ENCM_CTRL W 2 0x0; 73 LOST_STEPS R 20 -
"""
OTHER_NAMES = {"PWM_CONF": "PWMCONF", "MSLUT__": "MSLUT[0]"}
FIELD_NAMES = {
    "DIAG0_ERROR__ONLY_WITH_SD_MODE_1_": "diag0_error",
    "DIAG0_OTPW__ONLY_WITH_SD_MODE_1_": "diag0_otpw",
    "TFD_2__0_": "tfd_2_0",
    "TFD__": "fd3",
}
NARROWER = {"XDIRECT_MODE", "VDCMIN"}
"""PY has 24 bits of XDIRECT, whose fields take 25, and 27 of VDCMIN, of which a TMC5130 has 23."""


def test_every_word() -> None:
    assert [
        f"{row.address:02x} {row.name} {row.access.value}{'-' if row.read_clears else ''} {row.width} "
        f"{'-' if row.reset is None else f'{row.reset:#x}'}"
        for row in TABLE
    ] == [" ".join(word.split()) for word in WORDS.split(";")]


def test_it_has_the_registers_that_pytrinamic_names_and_no_other() -> None:
    theirs = {OTHER_NAMES.get(name, name): at for name, at in vars(TMC2130.REG).items() if name.isupper()}
    assert {
        row.name: row.address for row in TABLE if not row.name.startswith("MSLUT[") or row.address == 0x60
    } == theirs


def test_its_fields_lie_where_pytrinamic_has_them() -> None:
    known = {name: value for name, value in vars(TMC2130.FIELD).items() if isinstance(value, tuple)}
    assert len(known) > 80
    for name, (address, mask, shift) in known.items():
        row = TABLE.at(address)
        assert row is not None, name
        field = row.field_named(FIELD_NAMES.get(name, name))
        found = (row.mask, 0) if field is None else (field.mask, field.lsb)
        assert found == (mask, shift) or name in NARROWER, name


def test_spi_leads_to_it_and_an_evaluation_board() -> None:
    model = MODELS["tmc2130"]
    assert (model.datagram_bits, model.uart, model.version, model.version_address) == (40, "", 0x11, 0x04)
    assert model.wires == {"emulator", "tcp", "spidev", "landungsbruecke", "cover"}
    assert (model.slot.side, model.board) == ("driver", "TMC2130")
    assert not model.counts_position
    assert not model.can("own_velocity")
