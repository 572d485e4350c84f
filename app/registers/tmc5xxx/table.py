"""Registers of the TMC5031 to TMC5240: 40-bit datagrams, 7-bit addresses, 32 data bits.

All have the same ramp generator and nearly the same driver. Of the chips with two axes the second has its own copy of
the ramp, switches and encoder 0x20 above the first, of the driver 0x10 and of StealthChop 0x08 above; the TMC5072 has
one microstep table for both. Rows by subject are in the files beside this one, sources in `rows`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import GLOBAL_AXIS, Register, RegisterTable
from . import driver, general, motion, tmc5240
from .behaviour import with_behaviour
from .rows import sheet

AXES = {"tmc5031": 2, "tmc5062": 2, "tmc5072": 2, "tmc5130": 1, "tmc5160": 1, "tmc5240": 1}
CLOCK_HZ_DEFAULT = 16e6
CLOCK_HZ_MIN = 4e6
CLOCK_HZ_MAX = 18e6

RAMP_STEP = 0x20
"""From the first axis to the second: ramp, switches, currents, encoder."""
DRIVER_STEP = 0x10
PWM_STEP = 0x08

_Rows = tuple[Register, ...]
_Block = tuple[int, _Rows]
"""How far the second axis is from the first, and the rows of the first."""


def _rows(model: str, globals_: _Rows, first: _Rows, blocks: tuple[_Block, ...]) -> Iterator[Register]:
    """globals_: of the whole chip; first: of the first axis alone; blocks: of every axis."""
    placed: list[tuple[Register, int | None]] = [(row, GLOBAL_AXIS) for row in globals_]
    placed += [(row, 0) for row in first]
    for step, rows in blocks:
        for motor in range(AXES[model]):
            placed += [(replace(row, address=row.address + motor * step), motor) for row in rows]
    for row, axis in sorted(placed, key=lambda place: place[0].address):
        source = f"{sheet(model, row.name, row.group)}; {row.source}"
        yield with_behaviour(replace(row, source=source)).completed(axis)


_MOTION = (motion.XLATCH, motion.ihold_irun(0x30), *motion.VELOCITY_THRESHOLDS)
_DUAL_RAMP = (*motion.ramp_rows(), *_MOTION, motion.ramp_stat(write_clears=False))
_DUAL_DRIVER = (*driver.PLACE_ROWS, driver.COOLCONF, driver.DRV_STATUS)
_OWN_TABLES = driver.table_rows("START_SIN90_120")
_ONE_TABLE = driver.table_rows("START_SIN90")
_DCCTRL_DUAL = driver.dcctrl(8, 8, "the data sheet alone tells the bits: API and PY have others")

_TMC5031 = _rows(
    "tmc5031",
    (general.GCONF_5031, general.GSTAT_DUAL, general.TEST_SEL, general.INPUT_5031),
    (general.X_COMPARE,),
    (
        (RAMP_STEP, (*_DUAL_RAMP, motion.SW_MODE_NO_ENCODER)),
        (DRIVER_STEP, (*_OWN_TABLES, *_DUAL_DRIVER, driver.CHOPCONF_5031)),
    ),
)
_TMC5062 = _rows(
    "tmc5062",
    (
        general.GCONF_5062,
        general.GSTAT_DUAL,
        general.IFCNT,
        general.SLAVECONF,
        general.INPUT_5062,
        general.OUTPUT_5062,
    ),
    (general.X_COMPARE,),
    (
        (RAMP_STEP, (*_DUAL_RAMP, motion.VDCMIN, motion.SW_MODE, *motion.ENCODER_5062)),
        (DRIVER_STEP, (*_OWN_TABLES, *_DUAL_DRIVER, driver.CHOPCONF_5062, _DCCTRL_DUAL)),
    ),
)
_TMC5072 = _rows(
    "tmc5072",
    (
        general.GCONF_5072,
        general.GSTAT_DUAL,
        general.IFCNT,
        general.nodeconf("the data sheet alone tells the bits: API and PY have 4 and 4"),
        general.INPUT_5072,
        general.OUTPUT_5072,
        *_ONE_TABLE,
    ),
    (general.X_COMPARE,),
    (
        (RAMP_STEP, (*_DUAL_RAMP, motion.VDCMIN, motion.SW_MODE, *motion.ENCODER_5072)),
        (DRIVER_STEP, (*_DUAL_DRIVER, driver.CHOPCONF_5072, _DCCTRL_DUAL)),
        (PWM_STEP, driver.PWM_5072),
    ),
)
_SINGLE_DRIVER = (*_ONE_TABLE, *driver.PLACE_ROWS, driver.COOLCONF, driver.dcctrl(10, 16), driver.LOST_STEPS)
_SINGLE_MOTION = (motion.ihold_irun(0x10), motion.VDCMIN, motion.SW_MODE, motion.XLATCH)
_TMC5130 = _rows(
    "tmc5130",
    (
        general.GCONF_5130,
        general.GSTAT_5130,
        general.IFCNT,
        general.nodeconf(),
        general.IOIN_5130,
        general.OUTPUT_PIN,
    ),
    (
        general.X_COMPARE,
        *motion.ramp_rows(),
        *_SINGLE_MOTION,
        *motion.time_threshold_rows(0, "delay from standstill to the lower current; 1 is the shortest, then one less"),
        motion.ramp_stat(write_clears=False),
        *motion.ENCODER_5130,
        *_SINGLE_DRIVER,
        driver.CHOPCONF_5130,
        driver.DRV_STATUS,
        *driver.PWM_5130,
        driver.ENCM_CTRL,
    ),
    (),
)
_TMC5160 = _rows(
    "tmc5160",
    (
        general.GCONF_5160,
        general.GSTAT_5160,
        general.IFCNT,
        general.nodeconf(),
        general.IOIN_5160,
        general.OUTPUT_PIN,
        *general.OTP_5160,
    ),
    (
        general.X_COMPARE,
        *general.CURRENT_5160,
        *motion.ramp_rows(vstop_reset=1),
        *_SINGLE_MOTION,
        *motion.time_threshold_rows(0xA, "delay from standstill to the lower current; StealthChop needs 2 or more"),
        motion.ramp_stat(write_clears=True),
        *motion.ENCODER_5160,
        *_SINGLE_DRIVER,
        driver.CHOPCONF_5160,
        driver.DRV_STATUS_5160,
        *driver.PWM_5160,
    ),
    (),
)
_TMC5240 = _rows("tmc5240", tmc5240.CHIP, (*tmc5240.AXIS, *tmc5240.RAMP, *tmc5240.ADC, *tmc5240.DRIVER), ())

TABLES = {
    "tmc5031": RegisterTable("tmc5031", tuple(_TMC5031)),
    "tmc5062": RegisterTable("tmc5062", tuple(_TMC5062)),
    "tmc5072": RegisterTable("tmc5072", tuple(_TMC5072)),
    "tmc5130": RegisterTable("tmc5130", tuple(_TMC5130)),
    "tmc5160": RegisterTable("tmc5160", tuple(_TMC5160)),
    "tmc5240": RegisterTable("tmc5240", tuple(_TMC5240)),
}
"""Every register of each chip, by model name. Axes count from 0."""

__all__ = ["AXES", "CLOCK_HZ_DEFAULT", "CLOCK_HZ_MAX", "CLOCK_HZ_MIN", "DRIVER_STEP", "PWM_STEP", "RAMP_STEP", "TABLES"]
