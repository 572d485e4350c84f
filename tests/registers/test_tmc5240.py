"""The registers of the TMC5240 against the masks of PyTrinamic, and a list written down from the maker's header."""

from __future__ import annotations

import pytest
from pytrinamic.ic import TMC5240

from app.registers.catalog import MODELS
from app.registers.model import Access
from app.registers.tmc5xxx.table import TABLES

TABLE = TABLES["tmc5240"]
# Address, name, access, width (s: signed), reset (-: no source tells), without the microstep table's eight words.
WORDS = """
    00 GCONF RW 21 0x8; 01 GSTAT R+WC 5 -; 02 IFCNT R 8 -; 03 NODECONF RW 12 0x0; 04 IOIN R 32 -; 04 OUTPUT W 13
    0x1000; 05 X_COMPARE RW s32 0x0; 06 X_COMPARE_REPEAT RW 24 0x0; 0a DRV_CONF RW 12 0x20; 0b GLOBAL_SCALER RW
    8 0x0; 10 IHOLD_IRUN RW 28 0x4011f08; 11 TPOWERDOWN RW 8 0xa; 12 TSTEP R 20 -; 13 TPWMTHRS RW 20 0x0; 14
    TCOOLTHRS RW 20 0x0; 15 THIGH RW 20 0x0; 20 RAMPMODE RW 2 0x0; 21 XACTUAL RW s32 0x0; 22 VACTUAL R s24 -; 23
    VSTART RW 18 0x0; 24 A1 RW 18 0x0; 25 V1 RW 20 0x0; 26 AMAX RW 18 0x0; 27 VMAX RW 23 0x0; 28 DMAX RW 18 0x0;
    29 TVMAX RW 16 0x0; 2a D1 RW 18 0xa; 2b VSTOP RW 18 0xa; 2c TZEROWAIT RW 16 0x0; 2d XTARGET RW s32 0x0; 2e
    V2 RW 20 0x0; 2f A2 RW 18 0x0; 30 D2 RW 18 0xa; 31 AACTUAL R s24 -; 33 VDCMIN RW 23 0x0; 34 SW_MODE RW 15
    0x0; 35 RAMP_STAT R+WC 16 -; 36 XLATCH R s32 -; 38 ENCMODE RW 11 0x0; 39 X_ENC RW s32 0x0; 3a ENC_CONST RW
    s32 0x10000; 3b ENC_STATUS R+WC 2 -; 3c ENC_LATCH R s32 -; 3d ENC_DEVIATION RW 20 0x0; 3e VIRTUAL_STOP_L RW
    s32 0x0; 3f VIRTUAL_STOP_R RW s32 0x0; 50 ADC_VSUPPLY_AIN R 29 -; 51 ADC_TEMP R 13 -; 52 OTW_OV_VTH RW 29
    0xb920f25; 68 MSLUTSEL RW 32 0xffff8056; 69 MSLUTSTART RW 32 0xf70000; 6a MSCNT R 10 -; 6b MSCURACT R 25 -;
    6c CHOPCONF RW 32 0x10410150; 6d COOLCONF RW 25 0x0; 6e DCCTRL RW 24 0x0; 6f DRV_STATUS R 32 -; 70 PWMCONF
    RW 32 0xc40c001e; 71 PWM_SCALE R 25 -; 72 PWM_AUTO R 24 -; 74 SG4_THRS RW 10 0x0; 75 SG4_RESULT R 10 -; 76
    SG4_IND R 32 -
"""
OTHER_NAMES = {
    "INP_OUT": "IOIN",
    "SLAVECONF": "NODECONF",
    "SWMODE": "SW_MODE",
    "RAMPSTAT": "RAMP_STAT",
    "XENC": "X_ENC",
    "DRVSTATUS": "DRV_STATUS",
    "PWMSCALE": "PWM_SCALE",
    "OTP_PROG": "X_COMPARE_REPEAT",
}
"""PyTrinamic's names, and ours; at 0x06 its table has what TMC-API does not."""
FIELD_NAMES = {
    "FAST_STANDSTILL": "faststandstill",
    "DIAG0_NINT_STEP": "diag0_stall_step",
    "SLAVEADDR": "NODEADDR",
    "DIAG1_NPOSCOMP_DIR": "diag1_stall_dir",
    "REFL": "REFL_STEP",
    "REFR": "REFR_DIR",
    "ENCB": "ENCB_CFG4",
    "ENCA": "ENCA_CFG5",
    "ENCN": "ENCN_CFG6",
    "HSTRT_TFD210": "hstrt",
    "HEND_OFFSET": "hend",
}


def test_every_word() -> None:
    wanted = [" ".join(word.split()) for word in WORDS.split(";")]
    assert [
        f"{row.address:02x} {row.name} {row.access.value} {'s' if row.signed else ''}{row.width} "
        f"{'-' if row.reset is None else f'{row.reset:#x}'}"
        for row in TABLE
        if not row.name.startswith("MSLUT[")
    ] == wanted
    assert len(TABLE) == len(wanted) + 8


def test_it_has_the_registers_that_pytrinamic_names() -> None:
    theirs = {name: at for name, at in vars(TMC5240.REG).items() if name.isupper()}
    ours = {row.name: row.address for row in TABLE}
    for name, address in theirs.items():
        own = f"MSLUT[{name[5:]}]" if name[:5] == "MSLUT" and name[5:].isdigit() else OTHER_NAMES.get(name, name)
        assert ours.pop(own) == address, name
    assert set(ours) == {"OUTPUT", "VIRTUAL_STOP_L", "VIRTUAL_STOP_R"}


def test_its_fields_lie_where_pytrinamic_has_them() -> None:
    seen = 0
    for name, (address, mask, shift) in [
        (name, value) for name, value in vars(TMC5240.FIELD).items() if isinstance(value, tuple)
    ]:
        row = TABLE.at(address)
        assert row is not None
        field = row.field_named(FIELD_NAMES.get(name, name))
        if field is None:
            whole = name in ("POS_NEG_EDGE", "RESERVED", "VDCMIN") or row.mask == mask
            assert whole, name
            continue
        assert (field.mask, field.lsb) == (mask, shift), name
        seen += 1
    assert seen > 130


def test_what_the_catalog_says_of_it() -> None:
    model = MODELS["tmc5240"]
    assert (model.family, model.axes, model.uart, model.datagram_bits, model.version) == (
        "tmc5xxx",
        1,
        "node",
        40,
        0x40,
    )
    assert (model.clock_hz_default, model.current_scale) == (12.5e6, "full_scale")
    assert model.wires == MODELS["tmc5160"].wires
    assert model.capabilities == MODELS["tmc5160"].capabilities


def test_only_what_the_chip_says_by_itself_cannot_be_written() -> None:
    read_only = {row.name for row in TABLE if row.access is Access.R}
    assert read_only == {
        *(
            "IFCNT",
            "IOIN",
            "TSTEP",
            "VACTUAL",
            "AACTUAL",
            "XLATCH",
            "ENC_LATCH",
            "ADC_VSUPPLY_AIN",
            "ADC_TEMP",
            "MSCNT",
        ),
        *("MSCURACT", "DRV_STATUS", "PWM_SCALE", "PWM_AUTO", "SG4_RESULT", "SG4_IND"),
    }
    assert [row.name for row in TABLE if row.access is Access.W] == ["OUTPUT"], "which IOIN shows"


@pytest.mark.parametrize(("raw", "celsius"), [(0xB92, 120), (2038, 0)])
def test_the_reset_of_the_warning_is_what_the_header_says(raw: int, celsius: int) -> None:
    assert (raw - 2038) / 7.7 == pytest.approx(celsius, abs=0.5)
    field = TABLE.get("OTW_OV_VTH", 0).field_named("OVERTEMPPREWARNING_VTH")
    assert field is not None
    assert field.reset == 0xB92
