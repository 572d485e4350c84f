"""Axis parameters of the TMCM-1161 (SAP, GAP). Sources: see `tmcm1161`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from ..build import RW, R
from ..model import Register, Space
from ..tmc428.roles import ACCELERATION_UNIT, VELOCITY_UNIT
from .build import Parameters
from .pd42 import PD42
from .pd42_axis import NO_RIPPLE

SOURCE = "PyTrinamic TMCM1161; STEPROCKER"
INT24 = (-(1 << 23), (1 << 23) - 1)
_UNITS_MAX = 2047
_SPEED = (0, _UNITS_MAX)
_BOTH_WAYS = (-_UNITS_MAX, _UNITS_MAX)
_DIVIDER = (0, 13)
_KEPT = "the emulator keeps it: its motor driver does nothing by it"

STORED = frozenset({4, 5, 6, 7, 12, 13, 130, 140, 149, 153, 154, 193, 194, 195, 204, 210, 212, 214})
"""What STEPROCKER's table calls storable, which STAP copies to EEPROM; not the ramp mode, which would move the motor as
it is restored."""

WITH_RIPPLE = "the emulated chopper acts on it with the option `ripple` of the emulated module alone"

_motion = Parameters("motion", SOURCE)
_units = Parameters("units", f"{SOURCE}; TMC429 9.9")
_ramp = Parameters("ramp", SOURCE)
_current = Parameters("current", SOURCE)
_switches = Parameters("switches", SOURCE)
_chopper = Parameters("chopper", SOURCE)
_coolstep = Parameters("coolstep", SOURCE)
_encoder = Parameters("encoder", "FM-TMCM-1161 6.2")
_step_dir = Parameters("step/dir", "PyTrinamic TMCM1161")


def _as_there(number: int, source: str = SOURCE, **other: Any) -> Register:
    """The row of the PD42-1241 of that number, which means the same here, but for `other`.

    Its defaults are that module's own, and so is what unit mode makes of a range.
    """
    row = PD42.at(number, Space.AXIS)
    assert row is not None
    return replace(row, **{"source": source, "reset": None, "internal_range": None, "driver": None, **other})


def _rows() -> Iterator[Register]:
    # --- motion -----------------------------------------------------------------------------------
    yield _as_there(0, range=INT24)
    yield _as_there(1, range=INT24, reset=0)
    yield _as_there(2, range=_BOTH_WAYS, unit=VELOCITY_UNIT, reset=0)
    yield _as_there(3, range=_BOTH_WAYS, unit=VELOCITY_UNIT)
    yield _as_there(8)
    yield _motion(
        138,
        "ramp_mode",
        RW,
        (0, 2),
        "what drives the axis; every motion command sets it, and writing it sets the motor in motion",
    ).having(values={0: "position", 1: "soft", 2: "velocity"}, reset=0, volatile=True)
    # --- ramp -------------------------------------------------------------------------------------
    yield _units(153, "ramp_div", RW, _DIVIDER, "divider that accelerations count by: one more halves all of them")
    yield _units(
        154, "pulse_div", RW, _DIVIDER, "divider that speeds and accelerations count by: one more halves all of them"
    )
    yield _as_there(4, range=_SPEED, unit=VELOCITY_UNIT, help="speed of a move between its ramps")
    yield _as_there(
        5, range=_SPEED, unit=ACCELERATION_UNIT, help="both up and down, in positioning and in velocity mode"
    )
    yield _ramp(130, "minimum_speed", RW, _SPEED, "speed that a motion starts and ends with", unit=VELOCITY_UNIT)
    yield _ramp(135, "actual_acceleration", R, _SPEED, "acceleration at this moment", unit=ACCELERATION_UNIT)
    # --- current ----------------------------------------------------------------------------------
    yield _as_there(6)
    yield _as_there(7)
    yield _current(
        200, "boost_current", RW, (0, 255), "current while it speeds up or slows down; 0: as parameter 6"
    ).having(unit="1/255", source=f"{SOURCE}; TMCL-RS")
    yield _current(
        204,
        "freewheeling_delay",
        RW,
        (0, 65535),
        "time at standstill after which the motor is cut off from current; 0: never",
    ).having(unit="10 ms")
    yield _as_there(214, range=(1, 65535))
    yield _current(179, "vsense", RW, (0, 1), "full scale of the sense resistor's voltage").having(
        values={0: "high", 1: "low"}, behaviour=_KEPT
    )
    # --- switches ---------------------------------------------------------------------------------
    for number in (9, 10, 11, 12, 13):
        yield _as_there(number)
    yield _switches(
        141,
        "reference_switch_tolerance",
        RW,
        (0, 4095),
        "how far from its place the reference switch may close in three-switch mode",
    ).having(unit="microsteps", behaviour="the emulator keeps it: it has no three-switch mode")
    yield _switches.switch(149, "soft_stop_flag", "1: slow down at a switch instead of stopping dead")
    yield _switches.switch(150, "end_switch_power_down", "1: no current at a stop switch", behaviour=_KEPT)
    # --- motor ------------------------------------------------------------------------------------
    yield _as_there(140, reset=8, source="FM-TMCM-1161 6.2")
    # --- chopper ----------------------------------------------------------------------------------
    yield _as_there(160)
    yield _as_there(162, behaviour=WITH_RIPPLE)
    yield _as_there(163)
    yield _chopper(
        164,
        "chopper_hysteresis_decrement",
        RW,
        (0, 3),
        "how soon the hysteresis shrinks; with constant off time 2 and 3 end fast decay by time alone",
    ).having(behaviour=NO_RIPPLE)
    yield _as_there(165, range=(-3, 12))
    for number in (166, 167, 184):
        yield _as_there(number)
    yield _chopper(
        175, "slope_control_high_side", RW, (0, 3), "slope of the high side drivers; more is steeper", behaviour=_KEPT
    )
    yield _chopper(
        176, "slope_control_low_side", RW, (0, 3), "slope of the low side drivers; more is steeper", behaviour=_KEPT
    )
    yield _chopper.switch(177, "short_protection_disable", "1: no protection against shorts to ground", behaviour=_KEPT)
    yield _chopper(178, "short_detection_time", RW, (0, 3), "how long a short has to last").having(
        values={0: "3.2 us", 1: "1.6 us", 2: "1.2 us", 3: "0.8 us"}, behaviour=_KEPT
    )
    # --- StallGuard and CoolStep ------------------------------------------------------------------
    for number in (173, 174, 206, 207, 208):
        yield _as_there(number)
    yield _as_there(181, range=_SPEED, unit=VELOCITY_UNIT, reset=0)
    for number in (168, 169, 170, 171, 172, 180):
        yield _as_there(number)
    yield _as_there(182, range=_SPEED, unit=VELOCITY_UNIT, help="CoolStep works above this speed")
    yield _coolstep(
        183,
        "smartenergy_slow_run_current",
        RW,
        (0, 255),
        "run current below the threshold speed (AP 182); 0: as parameter 6",
    ).having(unit="1/255")
    # --- encoder ----------------------------------------------------------------------------------
    yield _as_there(209, range=INT24, source="FM-TMCM-1161 6.2")
    yield _encoder(
        210,
        "encoder_prescaler",
        RW,
        (0, 65535),
        "microsteps of a count of the encoder, which has 1024 a turn; bit 2 clears the counter at each null",
    ).having(unit="1/512 microsteps", reset=25600)
    yield _as_there(212, range=(0, 65535), reset=0, source="FM-TMCM-1161 6.2")
    yield _as_there(215)
    # --- reference search -------------------------------------------------------------------------
    yield _as_there(193)
    yield _as_there(194, range=_SPEED, unit=VELOCITY_UNIT)
    yield _as_there(195, range=_SPEED, unit=VELOCITY_UNIT)
    yield _as_there(196, range=INT24)
    yield _as_there(197, range=INT24)
    # --- step/direction ---------------------------------------------------------------------------
    yield _as_there(161)
    yield _step_dir(
        254,
        "step_direction_mode",
        RW,
        (0, 5),
        "1..5: inputs move the motor, and by which the current goes down differs; ROR, ROL, MVP and MST do nothing",
    ).having(reset=0)


AXIS_PARAMETERS = tuple(
    replace(row, stored="on request") if row.address in STORED else row
    for row in sorted(_rows(), key=lambda row: row.address)
)
