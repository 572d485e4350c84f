"""Registers of the TMC2130: the driver of a TMC5130 without its ramp generator, 40-bit datagrams over SPI alone.

Sources: API (`tmc/ic/TMC2130`: fields, access, the microstep table and PWMCONF after a reset), PY, KLIPPER-TMC2130. Its
data sheet was not at hand but for the headline: what a field does is taken from the TMC5130's, whose driver has the
same fields in the same places. What API writes to IHOLD_IRUN and CHOPCONF at the start is its own, no reset.
"""

from __future__ import annotations

from dataclasses import replace

from ..model import Register
from ..tmc5xxx import driver, general, motion
from .rows import PLACE_ROWS, direct_row, table_like

VERSION = 0x11
VERSION_ADDRESS = 0x04
NO_DCSTEP = "the emulated driver has no DcStep: its steps come whether the motor can follow or not"

_PINS = 6
"""Of IOIN: the others of a TMC5130 this chip does not have."""
_GCONF = {
    "enc_commutation": "the encoder commutates the motor: for the factory, stays off",
    "stop_enable": "the pin DCIN_CFG5 stops the motor at once while it is high",
    "direct_mode": "XDIRECT sets both coil currents instead of STEP and DIR",
}
GCONF = replace(
    general.GCONF_5130,
    fields=tuple(
        replace(part, help=_GCONF.get(part.name, part.help), when="")
        for part in general.GCONF_5130.fields
        if part.name not in ("diag0_step", "diag1_dir")
    ),
)
IOIN = replace(
    general.IOIN_5130, fields=tuple(p for p in general.IOIN_5130.fields if p.lsb < _PINS or p.name == "VERSION")
)


def _still(row: Register) -> Register:
    """A row of DcStep."""
    return replace(row, behaviour=NO_DCSTEP)


TABLE = table_like(
    "tmc2130",
    "tmc5130",
    (GCONF, general.GSTAT_5130, IOIN),
    (
        motion.ihold_irun(0x10),
        *motion.time_threshold_rows(0, "delay from standstill to the lower current; 1 is the shortest, then one less"),
        direct_row("XDIRECT", "COIL_"),
        _still(motion.VDCMIN),
        *driver.table_rows("START_SIN90"),
        *PLACE_ROWS,
        driver.CHOPCONF_5130,
        driver.COOLCONF,
        _still(driver.dcctrl(10, 16)),
        driver.DRV_STATUS,
        *driver.PWM_5130,
        driver.ENCM_CTRL,
        replace(driver.LOST_STEPS, behaviour=NO_DCSTEP),
    ),
)
