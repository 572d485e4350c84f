"""What the rows of the TMC5xxx share: units, names of values, sources.

Rows are written once, as the first axis has them; `tmc5xxx` puts them onto the axes of each chip. A source begins with
the chip's data sheet and the place in it, where that tells the row: DS-TMC5031 and DS-TMC5062 by section (their
revisions of 2023 and before), DS-TMC5072 (Rev. 1.26), DS-TMC5130 (Rev. 1.21) and DS-TMC5160 (Rev. 1.18) by page. Second
sources:

- FIELDS-TMC5240: what an older header of the maker says of each field of that chip, whose data sheet was not at hand;
- API: the vendor's TMC-API headers, and PY: PyTrinamic's tables; one origin, so together one source.
"""

from __future__ import annotations

from dataclasses import replace

from ..build import Rows
from ..model import Access, Register

MICROSTEPS = "microsteps"
CLOCKS = "tCLK"
VELOCITY_UNIT = "fCLK/2^24 pps"
ACCELERATION_UNIT = "fCLK^2/2^41 pps^2"
DELAY_UNIT = "2^18 tCLK"
SCALE_UNIT = "1/32, plus 1/32"

LOW_HIGH = {0: "low", 1: "high"}
ACTIVE_LEVEL = {0: "high active", 1: "low active"}
OPEN_PUSH = {0: "open drain", 1: "push-pull"}

VENDOR = "API; PY"
VENDOR_RESET = "API (reset)"

MODE_RAMP = "driver by the ramp generator (SD_MODE low)"
MODE_STEP_DIR = "driver by step and direction (SD_MODE high)"


def clearing(
    group: str, address: int, name: str, width: int, help_: str, write_clears: bool, what: str = "it"
) -> Register:
    """Flags that stay until they are cleared (`what` of them), by writing 1 or else by reading."""
    how = "writing 1" if write_clears else "reading"
    row = Rows(group, VENDOR).reading(address, name, width, f"{help_}; {how} clears {what}")
    return replace(row, access=Access.R_W1C) if write_clears else replace(row, read_clears=True)


_PAGES_5072 = {
    "GCONF": "p. 27",
    **dict.fromkeys(("GSTAT", "IFCNT", "NODECONF"), "p. 28"),
    "INPUT": "p. 28-29",
    **dict.fromkeys(("OUTPUT", "X_COMPARE"), "p. 29"),
    **dict.fromkeys(("IHOLD_IRUN", "VCOOLTHRS", "VHIGH"), "p. 32"),
    **dict.fromkeys(("VDCMIN", "XLATCH"), "p. 33"),
    "SW_MODE": "p. 34",
    "RAMP_STAT": "p. 35",
    "MSLUT": "p. 38",
    "MSLUTSTART": "p. 38",
    "MSLUTSEL": "p. 39",
    **dict.fromkeys(("MSCNT", "MSCURACT", "DCCTRL"), "p. 40"),
    "CHOPCONF": "p. 41-42",
    "COOLCONF": "p. 43",
    "DRV_STATUS": "p. 44",
    **dict.fromkeys(("PWMCONF", "PWM_STATUS"), "p. 45"),
    "ramp": "p. 30-31",
    "encoder": "p. 36-37",
}
_PAGES_5130 = {
    "GCONF": "p. 31-32",
    **dict.fromkeys(("GSTAT", "IFCNT"), "p. 32"),
    **dict.fromkeys(("NODECONF", "IOIN", "OUTPUT", "X_COMPARE"), "p. 33"),
    **dict.fromkeys(("IHOLD_IRUN", "TPOWERDOWN", "TSTEP"), "p. 34"),
    **dict.fromkeys(("TPWMTHRS", "TCOOLTHRS", "THIGH"), "p. 35"),
    **dict.fromkeys(("VDCMIN", "XLATCH"), "p. 38"),
    "SW_MODE": "p. 39",
    "RAMP_STAT": "p. 40",
    "MSLUT": "p. 43",
    "MSLUTSTART": "p. 43",
    "MSLUTSEL": "p. 46",
    **dict.fromkeys(("MSCNT", "MSCURACT"), "p. 43"),
    **dict.fromkeys(("DCCTRL", "PWM_SCALE", "ENCM_CTRL", "LOST_STEPS"), "p. 44"),
    "PWMCONF": "p. 44, 50",
    "CHOPCONF": "p. 47-48",
    "COOLCONF": "p. 49",
    "DRV_STATUS": "p. 51",
    "ramp": "p. 36-37",
    "encoder": "p. 41-42",
}
_PAGES_5160 = {
    "GCONF": "p. 32-33",
    **dict.fromkeys(("GSTAT", "IFCNT"), "p. 33"),
    **dict.fromkeys(("NODECONF", "IOIN", "OUTPUT", "X_COMPARE"), "p. 34"),
    "OTP_PROG": "p. 34-35",
    "OTP_READ": "p. 35, 37",
    **dict.fromkeys(("FACTORY_CONF", "SHORT_CONF"), "p. 35"),
    "DRV_CONF": "p. 35-36",
    **dict.fromkeys(("GLOBAL_SCALER", "OFFSET_READ"), "p. 36"),
    **dict.fromkeys(("IHOLD_IRUN", "TPOWERDOWN", "TSTEP"), "p. 38"),
    **dict.fromkeys(("TPWMTHRS", "TCOOLTHRS", "THIGH"), "p. 39"),
    **dict.fromkeys(("VDCMIN", "XLATCH"), "p. 42"),
    "SW_MODE": "p. 43",
    "RAMP_STAT": "p. 44",
    "MSLUT": "p. 47",
    "MSLUTSTART": "p. 47",
    "MSLUTSEL": "p. 50",
    **dict.fromkeys(("MSCNT", "MSCURACT"), "p. 47"),
    **dict.fromkeys(("DCCTRL", "PWM_SCALE"), "p. 48"),
    "CHOPCONF": "p. 48, 51-52",
    "COOLCONF": "p. 53",
    "PWMCONF": "p. 48, 54-55",
    "PWM_AUTO": "p. 48-49",
    "LOST_STEPS": "p. 49",
    "DRV_STATUS": "p. 56",
    "ramp": "p. 40-41",
    "encoder": "p. 45-46",
}


_SECTIONS_5031 = {
    "ramp": "5.2.1",
    **dict.fromkeys(("IHOLD_IRUN", "VCOOLTHRS", "VHIGH", "XLATCH"), "5.2.2"),
    "SW_MODE": "5.2.2.1",
    "RAMP_STAT": "5.2.2.2",
    **dict.fromkeys(("MSLUT", "MSLUTSTART", "MSCNT", "MSCURACT"), "5.3"),
    "MSLUTSEL": "5.3.1",
    "CHOPCONF": "5.3.2",
    "COOLCONF": "5.3.3",
    "DRV_STATUS": "5.3.4",
    "": "5.1",
}
_SECTIONS_5062 = {
    "ramp": "6.2.1",
    **dict.fromkeys(("IHOLD_IRUN", "VCOOLTHRS", "VHIGH", "VDCMIN", "XLATCH", "RAMP_STAT"), "6.2.2"),
    "SW_MODE": "6.2.2.1",
    "encoder": "6.3",
    **dict.fromkeys(("MSLUT", "MSLUTSTART", "MSCNT", "MSCURACT", "DCCTRL"), "6.4"),
    "MSLUTSEL": "6.4.1",
    "CHOPCONF": "6.4.2, 6.4.3",
    "COOLCONF": "6.4.4",
    "DRV_STATUS": "6.4.5",
    "": "6.1",
}
_PLACES = {
    "tmc5031": _SECTIONS_5031,
    "tmc5062": _SECTIONS_5062,
    "tmc5072": _PAGES_5072,
    "tmc5130": _PAGES_5130,
    "tmc5160": _PAGES_5160,
}
"""Where a chip's data sheet tells a register: by its name, else by its group, else what stands at ""."""
_WITHOUT_SHEET = {"tmc5240": "FIELDS-TMC5240"}
"""What is cited of a chip whose data sheet nobody had."""


def sheet(model: str, name: str, group: str) -> str:
    """The chip's data sheet and where in it the register is told. Raises KeyError where nobody has looked that up."""
    if model in _WITHOUT_SHEET:
        return _WITHOUT_SHEET[model]
    places = _PLACES[model]
    for key in (name.partition("[")[0], group, ""):
        if key in places:
            return f"DS-{model.upper()} {places[key]}"
    raise KeyError(name)
