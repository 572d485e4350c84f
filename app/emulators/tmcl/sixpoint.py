"""Axis parameters of a module with a SixPoint ramp generator: a TMC5160 follows them (FM-PD42-1241 4)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from ...registers.tmcl.description import TmclModule
from ..drive import Drive
from . import units
from .parameters import (
    ACCELERATION,
    CURRENT_LOOP,
    DEVIATION,
    MICROSTEPS,
    MULTISTEP_FILTER,
    SPEED,
    STOP_ON_STALL,
    TARGET_SPEED,
    Configuration,
    Forced,
    Parameters,
)
from .refused import invalid_value

DECELERATION, SWAP, RIGHT_POLARITY, LEFT_POLARITY, SOFT_STOP = 17, 14, 24, 25, 26
SCALER, FULLSTEPS, EXTERNAL_COUNTS, EXTERNAL_DEVIATION, REVERSE, UNIT_MODE = 178, 202, 217, 218, 251, 255
_RAMP = frozenset({5, 15, 16, 17, 18, 19, 20, 21, 23})
_CURRENTS = frozenset({6, 7, 31, 178, 214})
_CHOPPER = frozenset({27, 28, 140, 160, 161, 162, 163, 164, 165, 166, 167, 184, 185})
_COOLSTEP = frozenset({168, 169, 170, 171, 172, 173, 174})
_PWM = frozenset({187, 188, 191, 192, 204, 251})
_THRESHOLDS = frozenset({22, 140, 182, 186})
_SWITCHES = frozenset({12, 13, 14, 24, 25, 26, 181})
_ENCODERS = frozenset({140, 202, 212, 217, 218, 251})
_DCSTEP = frozenset({32, 33})


class SixPointParameters(Parameters):
    """Speeds in pps or in units of the chip, by parameter 255.

    The manual's table of defaults is lost and no sister's fits this motor, so these are ours: a motor that turns one
    revolution a second at its rated current, with everything optional switched off.
    """

    SPEEDS = frozenset({TARGET_SPEED, 4, 16, 19, 20, 22, 23, 181, 182, 186, 194, 195})
    ACCELERATIONS = frozenset({5, 15, 17, 18})
    NULL_SWITCH = True
    OURS: ClassVar[Mapping[int, int]] = {
        4: 51_200,
        5: 51_200,
        6: 128,  # 2.1 A peak, 1.5 A RMS: the rating of the default motor
        7: 8,
        15: 51_200,
        17: 51_200,
        18: 51_200,
        19: 0,
        20: 10,
        21: 0,
        23: 0,
        31: 7,
        32: 0,
        33: 0,
        160: 0,
        162: 2,
        163: 0,
        164: 0,
        165: 3,
        166: 5,
        167: 5,
        168: 0,
        169: 0,
        170: 0,
        171: 0,
        173: 0,
        174: 0,
        178: 0,
        182: 0,
        185: 0,
        186: 0,
        188: 128,
        191: 0,
        193: 1,
        194: 51_200,
        195: 5_120,
        214: 200,
        217: 4_000,
    }

    def __init__(self, module: TmclModule, drive: Drive, stops_forced: Forced, configuration: Configuration) -> None:
        super().__init__(module, drive, stops_forced, configuration)
        self._pps: dict[int, int] = {}
        self.shown = self._pps

    def _start(self, values: Mapping[int, int]) -> None:
        self.shown = self._pps if values[UNIT_MODE] else self._chip

    def apply_all(self) -> None:
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

    def configured(self, number: int) -> None:
        """Nothing of the axis hangs on one."""

    @property
    def in_pps(self) -> bool:
        return self.shown is self._pps

    @property
    def speed_scale(self) -> tuple[float, float]:
        return 1.0, units.PPS if self.in_pps else 1.0

    # --- writing ---------------------------------------------------------------------------------

    def check(self, number: int, value: int) -> None:
        super().check(number, value)
        if number == SCALER and 0 < value < 32:
            raise invalid_value()  # the driver chip does not work there

    def _limits(self, number: int) -> tuple[int, int]:
        internal = self.rows[number].internal_range
        return super()._limits(number) if self.in_pps or internal is None else internal

    def write(self, number: int, value: int) -> None:
        if number == UNIT_MODE:
            self.values[number] = value
            self.shown = self._pps if value else self._chip
            return
        if self.counts(number):
            self.keep(number, value)
        else:
            self.values[number] = value
        self._apply(number)

    def keep(self, number: int, value: int) -> None:
        if number in self.SPEEDS:
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
        self._drive.write("IHOLD_IRUN", self._currents() | self.values[31] << 16)
        self._drive.write("TPOWERDOWN", self._power_down())
        self._drive.write("GLOBALSCALER", self.values[SCALER])

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

    def _apply_pwm(self) -> None:
        values = self.values
        word = values[188] | values[187] << 8 | values[191] << 16 | values[192] << 18 | values[204] << 20
        self._drive.write("PWMCONF", word | CURRENT_LOOP)
        stealth = int(values[187] > 0)
        self._drive.write("GCONF", MULTISTEP_FILTER | stealth << 2 | values[REVERSE] << 4)

    def _apply_thresholds(self) -> None:
        for number, register in ((22, "THIGH"), (182, "TCOOLTHRS"), (186, "TPWMTHRS")):
            self._drive.write(register, units.step_time(self._chip[number], self.microsteps))

    def _apply_dcstep(self) -> None:
        self._drive.write("DCCTRL", self.values[32] | self.values[33] << 16)

    def apply_switches(self) -> None:
        values, (left, right) = self.values, self._stops()
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
