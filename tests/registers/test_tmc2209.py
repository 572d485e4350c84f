"""The registers of the TMC2209 against PyTrinamic's masks, and resets written down from the data sheet."""

from __future__ import annotations

import pytest
from pytrinamic.ic import TMC2209

from app.registers.catalog import MODELS
from app.registers.model import Access

TABLE = MODELS["tmc2209"].table
# Address, name, access, width (s: signed), reset (-: none is told).
WORDS = """
    00 GCONF RW 10 0x101; 01 GSTAT R+WC 3 -; 02 IFCNT R 8 -; 03 NODECONF W 12 0x0; 04 OTP_PROG W 16 -; 05 OTP_READ R 24
    -; 06 IOIN R 32 -; 07 FACTORY_CONF RW 10 -; 10 IHOLD_IRUN W 20 0x11f10; 11 TPOWERDOWN W 8 0x14; 12 TSTEP R 20 -; 13
    TPWMTHRS W 20 0x0; 14 TCOOLTHRS W 20 0x0; 22 VACTUAL W s24 0x0; 40 SGTHRS W 8 0x0; 41 SG_RESULT R 10 -; 42 COOLCONF
    W 16 0x0; 6a MSCNT R 10 -; 6b MSCURACT R 25 -; 6c CHOPCONF RW 32 0x10000053; 6f DRV_STATUS R 32 -; 70 PWMCONF RW 32
    0xc10d0024; 71 PWM_SCALE R 25 -; 72 PWM_AUTO R 24 -
"""
OTHER_NAMES = {"SLAVECONF": "NODECONF"}
FIELD_NAMES = {
    "SLAVECONF": "SENDDELAY",
    "OTP0_BYTE_0_READ_DATA": "OTP0",
    "OTP1_BYTE_1_READ_DATA": "OTP1",
    "OTP2_BYTE_2_READ_DATA": "OTP2",
}


def test_every_word() -> None:
    wanted = [" ".join(word.split()) for word in WORDS.split(";")]
    assert [
        f"{row.address:02x} {row.name} {row.access.value} {'s' if row.signed else ''}{row.width} "
        f"{'-' if row.reset is None else f'{row.reset:#x}'}"
        for row in TABLE
    ] == wanted


def test_it_has_the_registers_that_pytrinamic_names_and_no_other() -> None:
    theirs = {OTHER_NAMES.get(name, name): at for name, at in vars(TMC2209.REG).items() if name.isupper()}
    assert {row.name: row.address for row in TABLE} == theirs


def test_its_fields_lie_where_pytrinamic_has_them() -> None:
    known = {name: value for name, value in vars(TMC2209.FIELD).items() if isinstance(value, tuple)}
    assert len(known) > 80
    for name, (address, mask, shift) in known.items():
        row = TABLE.at(address)
        assert row is not None, name
        field = row.field_named(FIELD_NAMES.get(name, name))
        found = (row.mask, 0) if field is None else (field.mask, field.lsb)
        assert found == (mask, shift), name


def test_what_it_resets_to_is_an_unburnt_memory() -> None:
    """DS-TMC2209 5.1.1: OTP_IHOLD 0 is 16, OTP_IHOLDDELAY 0 is 1, IRUN 31, PWM_OFS 36, toff 3 and hstrt 5."""
    assert TABLE.get("IHOLD_IRUN", 0).unpack(0x11F10) == {"IHOLD": 16, "IRUN": 31, "IHOLDDELAY": 1}
    pwm = TABLE.get("PWMCONF", 0).unpack(0xC10D0024)
    assert (pwm["PWM_OFS"], pwm["PWM_GRAD"], pwm["pwm_autoscale"], pwm["pwm_autograd"], pwm["pwm_freq"]) == (
        *(36, 0),
        *(1, 1, 1),
    )
    chopper = TABLE.get("CHOPCONF", 0).unpack(0x10000053)
    assert (chopper["toff"], chopper["hstrt"], chopper["hend"], chopper["intpol"]) == (3, 5, 0, 1)


def test_only_a_uart_leads_to_it() -> None:
    model = MODELS["tmc2209"]
    assert model.uart_alone
    assert (model.uart, model.nodes, model.version, model.version_address) == ("node", 4, 0x21, 0x06)
    assert model.wires == {"emulator", "uart"}
    assert not model.counts_position


@pytest.mark.parametrize("name", ["VACTUAL", "IHOLD_IRUN", "TCOOLTHRS", "SGTHRS"])
def test_what_moves_it_cannot_be_read(name: str) -> None:
    assert TABLE.get(name, 0).access is Access.W
