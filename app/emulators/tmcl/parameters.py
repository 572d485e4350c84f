"""Axis parameters that the firmware keeps and turns into registers of the driver chip (FM-PD42-1241 4).

What moves the motor or only tells (positions, flags, switches) is in `axis`.
"""

from __future__ import annotations

from collections.abc import Callable

from ...registers.model import Register, Space
from ...registers.tmcl.pd42 import PD42
from ..drive import Drive
from . import units
from .defaults import DEFAULTS
from .refused import invalid_value, wrong_type

ROWS: dict[int, Register] = {row.address: row for row in PD42 if row.space is Space.AXIS}
TARGET_SPEED, SPEED, ACCELERATION, CURRENT, STANDBY_CURRENT, DECELERATION = 2, 4, 5, 6, 7, 17
RIGHT_OFF, LEFT_OFF, SWAP, RIGHT_POLARITY, LEFT_POLARITY, SOFT_STOP = 12, 13, 14, 24, 25, 26
RELATIVE_TO, MICROSTEPS, SCALER, STOP_ON_STALL, FULLSTEPS = 127, 140, 178, 181, 202
SEARCH_MODE, SEARCH_SPEED, SWITCH_SPEED = 193, 194, 195
DEVIATION, EXTERNAL_COUNTS, EXTERNAL_DEVIATION, REVERSE, STEP_DIR, UNIT_MODE = 212, 217, 218, 251, 254, 255
_SPEEDS = frozenset({TARGET_SPEED, 4, 16, 19, 20, 22, 23, 181, 182, 186, 194, 195})
_ACCELERATIONS = frozenset({5, 15, 17, 18})
_RAMP = frozenset({5, 15, 16, 17, 18, 19, 20, 21, 23})
_CURRENTS = frozenset({6, 7, 31, 178, 214})
_CHOPPER = frozenset({27, 28, 140, 160, 161, 162, 163, 164, 165, 166, 167, 184, 185})
_COOLSTEP = frozenset({168, 169, 170, 171, 172, 173, 174})
_PWM = frozenset({187, 188, 191, 192, 204, 251})
_THRESHOLDS = frozenset({22, 140, 182, 186})
_SWITCHES = frozenset({12, 13, 14, 24, 25, 26, 181})
_ENCODERS = frozenset({140, 202, 212, 217, 218, 251})
_DCSTEP = frozenset({32, 33})
_CURRENT_STEP = 8
"""The driver makes 32 steps of the 256 values of a current."""
_CURRENT_LOOP = 4 << 24 | 12 << 28
"""PWM_REG and PWM_LIM as the chip has them after reset."""
_MULTISTEP_FILTER = 1 << 3


class Parameters:
    """Values by number, and the chip made to follow them."""

    def __init__(self, drive: Drive, stops_forced: Callable[[], bool | None]) -> None:
        """`stops_forced` tells what a reference search makes of the stop switches: on, off, or None: as configured."""
        self._drive = drive
        self._stops_forced = stops_forced
        self.values: dict[int, int] = {}
        """Everything that is no speed or acceleration, as it was written."""
        self._pps: dict[int, int] = {}
        self._chip: dict[int, int] = {}
        self.shown = self._pps
        """Speeds and accelerations as GAP shows them: in pps, or in units of the chip (parameter 255)."""
        self.positioning = False
        """Whether VMAX of the chip is the positioning speed now."""

    def power_on(self) -> None:
        """Defaults everywhere, and the chip set up."""
        self.shown = self._pps
        self.values.clear()
        for number, value in DEFAULTS.items():
            if number in _SPEEDS or number in _ACCELERATIONS:
                self.keep(number, value)
            else:
                self.values[number] = value
        for apply in (
            self.apply_ramp,
            self._apply_currents,
            self._apply_chopper,
            self._apply_coolstep,
            self._apply_pwm,
            self._apply_thresholds,
            self._apply_dcstep,
            self.apply_switches,
            self.apply_encoders,
        ):
            apply()

    # --- reading ---------------------------------------------------------------------------------

    def in_chip_units(self, number: int) -> int:
        """A speed or acceleration as the chip counts it."""
        return self._chip[number]

    @property
    def microsteps(self) -> int:
        """Microsteps of a full step."""
        return 1 << self.values[MICROSTEPS]

    @property
    def in_pps(self) -> bool:
        return self.shown is self._pps

    def speed_shown(self, chip_units: int) -> int:
        """A velocity of the chip in the user's unit."""
        return units.velocity_from_chip(chip_units) if self.in_pps else chip_units

    # --- writing ---------------------------------------------------------------------------------

    def check(self, number: int, value: int) -> None:
        """Raises Refused: status 3 for a parameter that cannot be written, 4 for a value out of range."""
        row = ROWS.get(number)
        if row is None or not row.access.writable:
            raise wrong_type()
        low, high = row.minimum, row.maximum
        if not self.in_pps and row.internal_range is not None:
            low, high = row.internal_range
        if not low <= value <= high or (row.values and value not in row.values):
            raise invalid_value()
        if number == SCALER and 0 < value < 32:
            raise invalid_value()  # the driver chip does not work there

    def write(self, number: int, value: int) -> None:
        """SAP of a parameter that is kept here; `check` has let it through."""
        if number == UNIT_MODE:
            self.values[number] = value
            self.shown = self._pps if value else self._chip
            return
        if number in _SPEEDS or number in _ACCELERATIONS:
            self.keep(number, value)
        else:
            self.values[number] = value
        self._apply(number)

    def keep(self, number: int, value: int) -> None:
        """A speed or acceleration in both units; what the user wrote comes back as it was."""
        if number in _SPEEDS:
            chip = units.velocity_to_chip(value) if self.in_pps else value
            pps = value if self.in_pps else units.velocity_from_chip(value)
        else:
            chip = units.acceleration_to_chip(value) if self.in_pps else value
            pps = value if self.in_pps else units.acceleration_from_chip(value)
        self._chip[number], self._pps[number] = chip, pps

    def _apply(self, number: int) -> None:
        if number in _RAMP:
            self.apply_ramp()
        if number == SPEED and self.positioning:
            self._drive.write("VMAX", self._chip[SPEED])
        if number in _CURRENTS:
            self._apply_currents()
        if number in _CHOPPER:
            self._apply_chopper()
        if number in _COOLSTEP:
            self._apply_coolstep()
        if number in _PWM:
            self._apply_pwm()
        if number in _THRESHOLDS:
            self._apply_thresholds()
        if number in _DCSTEP:
            self._apply_dcstep()
        if number in _SWITCHES:
            self.apply_switches()
        if number in _ENCODERS:
            self.apply_encoders()

    # --- registers of the chip -------------------------------------------------------------------

    def apply_ramp(self) -> None:
        write, chip = self._drive.write, self._chip
        write("AMAX", chip[ACCELERATION])
        write("A1", chip[15])
        write("V1", chip[16])
        write("DMAX", chip[DECELERATION])
        write("D1", chip[18])
        write("VSTART", chip[19])
        write(
            "VSTOP", max(chip[20], 1)
        )  # the chip never arrives with 0 (TMC5160 data sheet); FM-PD42-1241 1.3 allows it
        write("TZEROWAIT", self.values[21])
        write("VDCMIN", chip[23])

    def _apply_currents(self) -> None:
        values = self.values
        run, hold = values[CURRENT] // _CURRENT_STEP, values[STANDBY_CURRENT] // _CURRENT_STEP
        self._drive.write("IHOLD_IRUN", hold | run << 8 | values[31] << 16)
        self._drive.write("TPOWERDOWN", min(round(values[214] * 0.01 / units.DELAY_S), 255))
        self._drive.write("GLOBALSCALER", values[SCALER])

    def _apply_chopper(self) -> None:
        values = self.values
        word = values[167] | values[184] << 13 | values[163] << 14 | values[162] << 15 | values[185] << 20
        word |= values[28] << 18 | values[27] << 19 | (8 - values[MICROSTEPS]) << 24
        word |= values[160] << 28 | values[161] << 29
        if values[163]:  # constant off time: 165 is the fast decay time, 166 the offset of the sine
            word |= (values[165] & 7) << 4 | (values[165] >> 3) << 11 | values[166] << 7 | values[164] << 12
        else:
            word |= max(values[166] - 1, 0) << 4 | values[165] << 7
        self._drive.write("CHOPCONF", word)

    def _apply_coolstep(self) -> None:
        values = self.values
        word = values[172] | values[171] << 5 | values[170] << 8 | values[169] << 13 | values[168] << 15
        self._drive.write("COOLCONF", word | (values[174] & 0x7F) << 16 | values[173] << 24)

    def _apply_pwm(self) -> None:
        values = self.values
        word = values[188] | values[187] << 8 | values[191] << 16 | values[192] << 18 | values[204] << 20
        self._drive.write("PWMCONF", word | _CURRENT_LOOP)
        stealth = int(values[187] > 0)
        self._drive.write("GCONF", _MULTISTEP_FILTER | stealth << 2 | values[REVERSE] << 4)

    def _apply_thresholds(self) -> None:
        for number, register in ((22, "THIGH"), (182, "TCOOLTHRS"), (186, "TPWMTHRS")):
            self._drive.write(register, units.step_time(self._chip[number], self.microsteps))

    def _apply_dcstep(self) -> None:
        self._drive.write("DCCTRL", self.values[32] | self.values[33] << 16)

    def apply_switches(self) -> None:
        """SW_MODE: stop switches, and the stop on stall, which a speed of 0 switches off."""
        values, forced = self.values, self._stops_forced()
        left = not values[LEFT_OFF] if forced is None else forced
        right = not values[RIGHT_OFF] if forced is None else forced
        stall = self._chip[STOP_ON_STALL]
        word = left | right << 1 | values[LEFT_POLARITY] << 2 | values[RIGHT_POLARITY] << 3 | values[SWAP] << 4
        self._drive.write("SW_MODE", word | (stall > 0) << 10 | values[SOFT_STOP] << 11)
        self._drive.stall_stop_velocity = stall

    def apply_encoders(self) -> None:
        """Counts scaled to microsteps (FM-PD42-1241 6.2 and 6.3), and the deviations that stop the motor.

        Turning the shaft round (parameter 251) turns both encoders' count: else no deviation could be watched.
        """
        values, drive = self.values, self._drive
        turn = values[FULLSTEPS] * self.microsteps * (-1 if values[REVERSE] else 1)
        drive.internal.scale(turn, drive.options.encoders.internal_counts)
        # Without a resolution (0) there is nothing to scale by: a count is a microstep.
        drive.external.scale(*((turn, values[EXTERNAL_COUNTS]) if values[EXTERNAL_COUNTS] else (1, 1)))
        drive.internal.limit = values[DEVIATION]
        drive.external.limit = values[EXTERNAL_DEVIATION]
