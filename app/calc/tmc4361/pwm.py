"""PWM outputs of a TMC4361: frequency, amplitude over velocity, duty of both phases over the electrical turn.

Sources: DS-TMC4361 1.3.4 (frequency), NOTES-TMC4361-IO 9 (amplitude and duty).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..ramps.curve import FloatArray

PLACES = 1024
"""Places of the microstep wave in an electrical turn."""
FULL_AMPLITUDE = 0.5
"""Of the duty, around its middle of 1/2: all of the supply."""
PEAK = 248
"""What the wave's values are counted against: (247 + 1/2) / 248 of the amplitude at its top."""


@dataclass(frozen=True, slots=True)
class PwmSettings:
    """PWM_FREQ [clocks], PWM_AMPL, PWM_VMAX [pps], MS_OFFSET; without `scales` the amplitude is full at all speeds.

    Raises ValueError for a number that the registers cannot hold, and for a period of 0.
    """

    period_clocks: int = 0x280
    amplitude: int = 0
    full_at_pps: int = 0
    offset: int = 0
    scales: bool = False
    clock_hz: float = 16e6

    def __post_init__(self) -> None:
        for name, least, most in (
            ("period_clocks", 1, 0xFFFF),
            ("amplitude", 0, 0xFFFF),
            ("full_at_pps", 0, 0xFFFFFF),
            ("offset", 0, PLACES - 1),
        ):
            value = getattr(self, name)
            if not least <= value <= most:
                raise ValueError(f"{name} is {value}, allowed is {least}..{most}")
        if not self.clock_hz > 0:
            raise ValueError("clock_hz has to be above 0")

    @property
    def frequency_hz(self) -> float:
        return self.clock_hz / self.period_clocks

    def amplitude_at(self, speed_pps: FloatArray) -> FloatArray:
        """Amplitude of the duty, 0..1/2, at speeds of either sign."""
        speed = np.abs(np.asarray(speed_pps, dtype=np.float64))
        if not self.scales:
            return np.full(speed.shape, FULL_AMPLITUDE)
        least = (self.amplitude + 1) / 2**17
        if self.full_at_pps == 0:
            return np.where(speed > 0.0, FULL_AMPLITUDE, least)
        return least + (FULL_AMPLITUDE - least) * np.minimum(speed / self.full_at_pps, 1.0)

    def duty(self, wave: FloatArray, amplitude: float) -> tuple[FloatArray, FloatArray]:
        """Share of the period in which STPOUT_PWMA and DIROUT_PWMB are high, at every place of the electrical turn.

        wave : the 1024 values of the microstep wave, -248..247. Duties are whole clocks of the period.
        """
        places = np.arange(PLACES) + self.offset
        a, b = (wave[(places + ahead) % PLACES] + 0.5 for ahead in (0, PLACES // 4))
        return self._whole(0.5 + amplitude * a / PEAK), self._whole(0.5 + amplitude * b / PEAK)

    def _whole(self, duty: FloatArray) -> FloatArray:
        clocks: FloatArray = np.floor(duty * self.period_clocks + 0.5) / self.period_clocks
        return np.clip(clocks, 0.0, 1.0)
