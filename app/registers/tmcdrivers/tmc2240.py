"""Registers of the TMC2240: the driver of a TMC5240 without its ramp generator, over SPI and over a UART.

Which registers it has is told by API (`tmc/ic/TMC2240`), PY and KLIPPER, which agree; what they mean is taken from the
TMC5240's rows, whose fields are in the same places. All can be read back (API, table of access). Its data sheet was not
at hand but for the first page. What API writes to GCONF and CHOPCONF at the start is its board's, no reset.
"""

from __future__ import annotations

from dataclasses import replace

from ..model import Register
from ..tmc5xxx import tmc5240
from ..tmc5xxx.rows import VENDOR
from .rows import direct_row, table_like

VERSION = 0x40
VERSION_ADDRESS = 0x04
NO_DCSTEP = "the emulated driver has no DcStep: its steps come whether the motor can follow or not"

_CHIP = ("GCONF", "GSTAT", "IFCNT", "NODECONF", "IOIN", "OUTPUT")
_RAMP = {"X_COMPARE", "X_COMPARE_REPEAT", *(row.name for row in tmc5240.RAMP)}
_ENCODER = {"ENCMODE", "X_ENC", "ENC_CONST", "ENC_STATUS", "ENC_LATCH"}
_SISTER = {row.name: row for row in (*tmc5240.CHIP, *tmc5240.AXIS, *tmc5240.RAMP, *tmc5240.ADC, *tmc5240.DRIVER)}
_GCONF = {
    "diag0_stall_step": ("diag0_stall", "DIAG0 shows a stall"),
    "diag1_stall_dir": ("diag1_stall", "DIAG1 shows a stall"),
    "direct_mode": ("direct_mode", "DIRECT_MODE sets both coil currents instead of STEP and DIR"),
}
"""Fields that are called otherwise, or do something else, without a ramp generator."""
_NOT_HERE = {"GCONF": ("length_step_pulse",), "DRV_CONF": ("BBM_CLKS",), "CHOPCONF": ("rndtf",)}
"""Fields that no source tells of this chip."""


def _row(row: Register) -> Register:
    """A row of the sister as this chip has it."""
    source = VENDOR if row.name in ("DRV_CONF", "CHOPCONF", "MSCURACT") else row.source
    row = replace(row, source=source, behaviour=NO_DCSTEP if row.name == "DCCTRL" else row.behaviour)
    gone = _NOT_HERE.get(row.name)
    if gone is None:
        return row
    kept = [part for part in row.fields if part.name not in gone]
    fields = [replace(part, when="") if row.name == "GCONF" else part for part in kept]
    told = [_GCONF.get(part.name, (part.name, part.help)) for part in fields]
    fields = [replace(part, name=name, help=help_) for part, (name, help_) in zip(fields, told, strict=True)]
    return replace(row, width=max(part.lsb + part.width for part in fields), fields=tuple(fields))


TABLE = table_like(
    "tmc2240",
    "tmc5240",
    (_row(_SISTER[name]) for name in _CHIP),
    (
        direct_row("DIRECT_MODE", "DIRECT_COIL_"),
        *(_row(row) for name, row in _SISTER.items() if name not in _CHIP and name not in _RAMP - _ENCODER),
    ),
)
