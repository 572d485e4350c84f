"""What a chopper does to a motor's coil: times, ripple, frequencies and the speeds where the supply ends.

The formulas are those of the data sheets where these have one; each function names it. For the hysteresis of
SpreadCycle they have words alone: the ripple that it makes has to be more than what resistance lets the current lose
(DS-TMC5160 8.1), and the comparator is blind for the blank time. That is put into numbers here, with half a step of the
sine table (of 256) for each unit of hysteresis: a sum of 16 lifts the table's 248 to 256 and no more (DS-TMC5160 8.1,
HEND). Inferred, as is the estimate of the chopper's frequency. A motor on an oscilloscope knows better
(AN-SPREADCYCLE).

Sources: DS-TMC5160 7.2 to 8.1; DS-TMC5130 7 and 8; DS-TMC5072 8 and 9; DS-TMC5031 7; DS-TMC5062 8; AN-SPREADCYCLE
(Parameterization of spreadCycle).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

BLANK_CLOCKS = (16, 24, 36, 54)
"""By TBL."""
PWM_DIVIDERS = (1024, 683, 512, 410)
"""By pwm_freq: two PWM cycles take so many clocks."""
TABLE_PEAK = 248
"""Amplitude of the sine table, of 256."""
AMPLITUDE_MAX = 255
"""Of StealthChop's PWM."""
AMPLITUDE_RMS = 374.0
"""Supply over RMS voltage at amplitude 1: 256 * 256 / 248 * sqrt(2), as the sheets round it (DS-TMC5160 7.4)."""
GRADIENT = 1.46
"""As the sheets have it, for a back-EMF constant as RMS (DS-TMC5160 7.4): AMPLITUDE_RMS / 256."""


@dataclass(frozen=True)
class Winding:
    """A motor's coil at its supply. `current_a` is the RMS of the run current; all above 0 and finite.

    irun : the current scale that gives it. holding_torque_nm : None where nobody knows the back-EMF
    Raises ValueError outside.
    """

    resistance_ohm: float
    inductance_h: float
    current_a: float
    supply_v: float
    clock_hz: float
    irun: int = 31
    holding_torque_nm: float | None = None
    rated_current_a: float | None = None
    full_steps_per_rev: int = 200

    def __post_init__(self) -> None:
        for name in ("resistance_ohm", "inductance_h", "current_a", "supply_v", "clock_hz", "full_steps_per_rev"):
            value = getattr(self, name)
            if not 0 < value < math.inf:
                raise ValueError(f"{name} is above 0 and finite, got {value}")
        for name in ("holding_torque_nm", "rated_current_a"):
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise ValueError(f"{name} is above 0 and finite, got {value}")
        if not 0 <= self.irun <= 31:
            raise ValueError(f"irun is 0 to 31, got {self.irun}")

    @property
    def peak_a(self) -> float:
        return self.current_a * math.sqrt(2)

    @property
    def full_scale_peak_a(self) -> float:
        """What IRUN 31 would give [A]."""
        return self.peak_a * 32 / (self.irun + 1)

    @property
    def headroom(self) -> float:
        """Supply over the voltage that the run current takes at rest."""
        return self.supply_v / (self.resistance_ohm * self.current_a)

    # --- times ----------------------------------------------------------------------------------

    def blank_s(self, tbl: int) -> float:
        """How long the comparator is not looked at [s]."""
        return BLANK_CLOCKS[tbl] / self.clock_hz

    def off_s(self, toff: int) -> float:
        """One of the two slow decays of a cycle [s]: 24 + 32 TOFF clocks (DS-TMC5160 8.1, TOFF)."""
        return (24 + 32 * toff) / self.clock_hz

    def toff(self, chopper_hz: float) -> float:
        """TOFF before rounding, for slow decays of half a cycle together: (t_off fCLK - 24) / 32 (DS-TMC5160 8.1).

        The formula printed there subtracts 12; the results beside it, 3.0 and 4.25, and the length of TOFF take 24.
        """
        return (self.clock_hz / chopper_hz / 4 - 24) / 32

    def highest_chopper_hz(self, tbl: int, toff: int) -> float:
        """Two slow decays and two blank times are the shortest cycle (DS-TMC5160 8.1) [Hz]."""
        return 1 / (2 * self.off_s(toff) + 2 * self.blank_s(tbl))

    # --- ripple ---------------------------------------------------------------------------------

    def blank_ripple_a(self, tbl: int) -> float:
        """What the supply drives into the coil while nobody looks [A]."""
        return self.supply_v * self.blank_s(tbl) / self.inductance_h

    def decay_ripple_a(self, toff: int) -> float:
        """What resistance takes out of the coil in both slow decays of a cycle, at the current's peak [A]."""
        return self.resistance_ohm * self.peak_a * 2 * self.off_s(toff) / self.inductance_h

    def hysteresis(self, tbl: int, toff: int) -> float:
        """The least hysteresis whose band holds both ripples; not rounded, not limited."""
        return (self.blank_ripple_a(tbl) + self.decay_ripple_a(toff)) / self.band_a(1)

    def band_a(self, hysteresis: float) -> float:
        """From the lower to the upper edge of the band of that hysteresis [A]."""
        return hysteresis * self.full_scale_peak_a / TABLE_PEAK

    def chopper_hz(self, tbl: int, toff: int, hysteresis: float) -> float:
        """Estimate at rest and the current's peak [Hz]; 0 where the supply cannot drive that current.

        On up to the band's upper edge, slow decay, back with the supply's voltage to the lower edge, slow decay; both
        driven phases last at least the blank time.
        """
        drop = self.resistance_ohm * self.peak_a
        if self.supply_v <= drop:
            return 0.0
        band, decay, blank = self.band_a(hysteresis), self.decay_ripple_a(toff) / 2, self.blank_s(tbl)
        on_s = max(blank, (band + decay) * self.inductance_h / (self.supply_v - drop))
        back_s = max(blank, (band - decay) * self.inductance_h / (self.supply_v + drop))
        return 1 / (on_s + back_s + 2 * self.off_s(toff))

    # --- StealthChop ----------------------------------------------------------------------------

    def pwm_hz(self, pwm_freq: int) -> float:
        """2 fCLK over the divider (DS-TMC5160 7.2) [Hz]."""
        return 2 * self.clock_hz / PWM_DIVIDERS[pwm_freq]

    def lowest_current_a(self, tbl: int, pwm_freq: int) -> float:
        """Below it StealthChop does not regulate: t_blank f_PWM V / R (DS-TMC5160 7.3.1) [A]."""
        return self.blank_s(tbl) * self.pwm_hz(pwm_freq) * self.supply_v / self.resistance_ohm

    def amplitude(self, current_a: float | None = None) -> float:
        """PWM amplitude for a current at rest, as RMS; None for the run current: 374 R I / V (DS-TMC5160 7.4)."""
        return AMPLITUDE_RMS * self.resistance_ohm * (current_a or self.current_a) / self.supply_v

    # --- back-EMF -------------------------------------------------------------------------------

    @property
    def back_emf(self) -> float | None:
        """Holding torque over twice the rated current: RMS of a coil [V s/rad] (DS-TMC5160 7.4); None without it."""
        if self.holding_torque_nm is None:
            return None
        return self.holding_torque_nm / (2 * (self.rated_current_a or self.current_a))

    @property
    def gradient(self) -> float | None:
        """PWM_GRAD before rounding: C_BEMF 2 pi fCLK 1.46 / (V MSPR) (DS-TMC5160 7.4); None without a torque."""
        if self.back_emf is None:
            return None
        return self.back_emf * 2 * math.pi * self.clock_hz * GRADIENT / (self.supply_v * 256 * self.full_steps_per_rev)

    def stealth_limit_rad_s(self) -> float | None:
        """Where amplitude and gradient add up to 255: no faster with StealthChop at that current [rad/s].

        0 where rest takes more already; None without a torque.
        """
        if self.gradient is None:
            return None
        table_hz = max(AMPLITUDE_MAX - self.amplitude(), 0.0) * self.clock_hz / (256 * self.gradient)
        return table_hz / 256 / self.full_steps_per_rev * 2 * math.pi

    def current_limit_rad_s(self) -> float | None:
        """Where the supply no longer drives the current's peak against resistance, back-EMF and inductance [rad/s].

        (R I + k w)^2 + (N w L I)^2 = V^2, with the current in phase with the back-EMF, as under full load; k is the
        peak's constant and N = full steps / 4. 0 where rest takes more already; None without a torque. Own formula,
        from the motor's voltage equation.
        """
        if self.back_emf is None:
            return None
        k, drop = self.back_emf * math.sqrt(2), self.resistance_ohm * self.peak_a
        reactance = self.full_steps_per_rev / 4 * self.inductance_h * self.peak_a
        if drop >= self.supply_v:
            return 0.0
        a, half_b, c = k**2 + reactance**2, drop * k, drop**2 - self.supply_v**2
        return -c / (half_b + math.sqrt(half_b**2 - a * c))
