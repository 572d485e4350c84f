"""Axis parameters of a module with a TMC429 as motion controller and a TMC262 as motor driver.

Both are played by the drive that all modules have: its ramp generator with the same acceleration up and down, and with
starting and stopping at the minimum speed. Speeds and accelerations count by two dividers, as in the TMC429 (DS-TMC428
8.14). Where the two ramp generators differ, so does what is emulated: the drive counts speeds in steps of 0.95 pps and
accelerations in steps of 116 pps^2, and does 7.6 million pps^2 at most; the last microsteps are its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from ...calc.units.tmc428 import acceleration_hz_s, pulse_rate_hz
from ...registers.tmcl.pd42 import CLOCK_HZ
from . import units
from .parameters import (
    ACCELERATION,
    CURRENT_LOOP,
    CURRENT_STEP,
    DEVIATION,
    MICROSTEPS,
    MULTISTEP_FILTER,
    SPEED,
    STOP_ON_STALL,
    TARGET_SPEED,
    Parameters,
)

MIN_SPEED, SOFT_STOP, RAMP_DIV, PULSE_DIV, COOLSTEP_SPEED, PRESCALER = 130, 149, 153, 154, 182, 210
POLARITY, REVERSE = 79, 90
"""Global parameters: of both stop inputs, and of the shaft."""
PRESCALER_UNIT, COUNTS_A_TURN, SPECIAL, AT_NULL = 512, 1024, 7, 4
"""A prescaler of 1; counts of the encoder; bits of the prescaler that are something else, and the one that clears the
counter at the encoder's null (FM-TMCM-1161 6.2)."""
_RAMP = frozenset({ACCELERATION, MIN_SPEED})
BOOST, SLOW_RUN, FREEWHEELING = 200, 183, 204
_CURRENTS = frozenset({6, 7, 214, BOOST, SLOW_RUN, FREEWHEELING})
_CHOPPER = frozenset({MICROSTEPS, 160, 161, 162, 163, 164, 165, 166, 167, 184})
_COOLSTEP = frozenset({168, 169, 170, 171, 172, 173, 174})
_SWITCHES = frozenset({12, 13, SOFT_STOP, STOP_ON_STALL})
_VSTART_MAX = (1 << 18) - 1


class TrapezoidParameters(Parameters):
    """Speeds and accelerations of 0..2047, whose worth the dividers say.

    What no source tells of the delivered state is ours: a motor that turns one revolution a second at half current, and
    reaches that in a second.
    """

    SPEEDS = frozenset({TARGET_SPEED, SPEED, MIN_SPEED, STOP_ON_STALL, COOLSTEP_SPEED, 194, 195})
    ACCELERATIONS = frozenset({ACCELERATION})
    OURS: ClassVar[Mapping[int, int]] = {
        4: 1678,  # 51,200 pps with divider 3
        5: 110,  # 51,200 pps^2 with dividers 3 and 7
        6: 128,
        7: 8,
        130: 1,
        153: 7,
        154: 3,
        162: 2,
        165: 0,
        166: 5,
        167: 5,
        193: 1,
        194: 1678,
        195: 168,
        214: 200,
    }

    def _start(self, values: Mapping[int, int]) -> None:
        self.values[RAMP_DIV], self.values[PULSE_DIV] = values[RAMP_DIV], values[PULSE_DIV]

    def apply_all(self) -> None:
        for apply in (
            self.apply_ramp,
            self._apply_currents,
            self._apply_chopper,
            self._apply_coolstep,
            self._apply_driver,
            self._apply_thresholds,
            self.apply_switches,
            self._apply_encoder,
        ):
            apply()

    def configured(self, number: int) -> None:
        if number == POLARITY:
            self.apply_switches()
        elif number == REVERSE:
            self._apply_driver()
            self._apply_encoder()

    @property
    def speed_scale(self) -> tuple[float, float]:
        return pulse_rate_hz(1, self.values[PULSE_DIV], CLOCK_HZ) / units.PPS, 1.0

    def write(self, number: int, value: int) -> None:
        if self.counts(number):
            self.keep(number, value)
        else:
            self.values[number] = value
        if number in (RAMP_DIV, PULSE_DIV):
            for each, kept in list(self.shown.items()):
                self.keep(each, kept)
        self._apply(number)

    def keep(self, number: int, value: int) -> None:
        self.shown[number] = value
        pulse_div, ramp_div = self.values[PULSE_DIV], self.values[RAMP_DIV]
        if number in self.SPEEDS:
            pps = pulse_rate_hz(value, pulse_div, CLOCK_HZ) / units.PPS
            self._chip[number] = round(pps)
        else:
            pps2 = acceleration_hz_s(value, pulse_div, ramp_div, CLOCK_HZ)
            self._chip[number] = units.acceleration_to_chip(round(pps2)) if value else 0

    def _apply(self, number: int) -> None:
        divided = number in (RAMP_DIV, PULSE_DIV)
        if divided or number in _RAMP:
            self.apply_ramp()
        if (divided or number == SPEED) and self.positioning:
            self._drive.write("VMAX", self._chip[SPEED])
        if number in _CURRENTS:
            self._apply_currents()
        if number in _CHOPPER:
            self._apply_chopper()
        if number in _COOLSTEP:
            self._apply_coolstep()
        if divided or number in (MICROSTEPS, COOLSTEP_SPEED):
            self._apply_thresholds()
        if divided or number in _SWITCHES:
            self.apply_switches()
        if number in (PRESCALER, DEVIATION):
            self._apply_encoder()

    # --- registers of the drive ------------------------------------------------------------------

    def apply_ramp(self) -> None:
        write, slope = self._drive.write, self._chip[ACCELERATION]
        slowest = min(self._chip[MIN_SPEED], _VSTART_MAX)
        for register in ("AMAX", "A1", "DMAX", "D1"):
            write(register, slope)
        write("V1", 0)
        write("VSTART", slowest)
        write("VSTOP", max(slowest, 1))
        write("TZEROWAIT", 0)

    def _apply_currents(self) -> None:
        self._drive.write("IHOLD_IRUN", self._currents())
        self._drive.write("TPOWERDOWN", self._power_down())
        self._drive.write("GLOBALSCALER", 0)
        boost, slow = (
            self.values[number] // CURRENT_STEP + 1 if self.values[number] else 0 for number in (BOOST, SLOW_RUN)
        )
        self._drive.set_module_currents(boost, slow, self.values[FREEWHEELING] * 0.01)

    def _apply_chopper(self) -> None:
        values = self.values
        word = values[167] | values[184] << 13 | values[163] << 14 | values[162] << 15
        word |= (8 - values[MICROSTEPS]) << 24 | values[160] << 28 | values[161] << 29
        end = values[165] + 3
        if values[163]:  # constant off time: 165 is the fast decay time, 166 the offset of the sine
            word |= (end & 7) << 4 | (end >> 3) << 11 | values[166] << 7 | (values[164] >> 1) << 12
        else:
            word |= max(values[166] - 1, 0) << 4 | end << 7
        self._drive.write("CHOPCONF", word)

    def _apply_driver(self) -> None:
        self._drive.write("PWMCONF", CURRENT_LOOP)
        self._drive.write("GCONF", MULTISTEP_FILTER | self._configuration(REVERSE) << 4)

    def _apply_thresholds(self) -> None:
        self._drive.write("THIGH", 0)
        self._drive.write("TPWMTHRS", 0)
        self._drive.write("TCOOLTHRS", units.step_time(self._chip[COOLSTEP_SPEED], self.microsteps))

    def apply_switches(self) -> None:
        (left, right), stall = self._stops(), self._chip[STOP_ON_STALL]
        inverted = self._configuration(POLARITY)
        word = left | right << 1 | inverted << 2 | inverted << 3
        self._drive.write("SW_MODE", word | (stall > 0) << 10 | self.values[SOFT_STOP] << 11)
        self._drive.stall_stop_velocity = stall

    def _apply_encoder(self) -> None:
        """Counts made microsteps by the prescaler, and the deviation that stops the motor."""
        prescaler = self.values[PRESCALER]
        turn = (prescaler & ~SPECIAL) * COUNTS_A_TURN * (-1 if self._configuration(REVERSE) else 1)
        internal = self._drive.internal
        internal.scale(turn, PRESCALER_UNIT * self._drive.options.encoders.internal_counts)
        if prescaler & AT_NULL:
            internal.clear_on_null = True
        internal.limit = self.values[DEVIATION]
        self._drive.external.limit = 0
