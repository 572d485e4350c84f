"""Where a TMC5xxx keeps its StealthChop (DS-TMC5160 6.3, 7; DS-TMC5130 7; FIELDS-TMC5240)."""

from __future__ import annotations

from ...calc.tmc5xxx.chopper import PWM_DIVIDERS, Winding
from ...calc.tmc5xxx.chopper_hints import hints
from ...calc.tmc5xxx.stealth import pwm_setting
from ...calc.units.tmc5xxx_times import TABLE_MICROSTEPS, TSTEP_MAX, tstep
from ..field_settings import Place
from ..stealthchop.setting import Motor, StealthPlaces

PWM_HZ = 20e3, 50e3
"""What suits most motors (DS-TMC5160 7.2)."""
SURE = 1.15
"""By so much: resistance and supply are not known better than within a tenth or so."""


class SheetCalculator:
    """The calculator of the page Current and chopper."""

    def first(self, model: str, motor: Motor) -> tuple[int | None, int | None]:
        """374 R I / V; C_BEMF 2 pi fCLK 1.46 / (V MSPR) (DS-TMC5160 7.4)."""
        found = {each.field: each.value for each in hints(model, _winding(motor)).settings}
        return (found["PWM_OFS"], found.get("PWM_GRAD")) if "PWM_OFS" in found else (None, None)

    def suiting(self, motor: Motor) -> list[int]:
        """20 to 50 kHz, from the middle of them on; the middle itself where the clock lets none be."""
        best, winding = pwm_setting(motor.clock_hz), _winding(motor)
        others = [each for each in range(len(PWM_DIVIDERS)) if PWM_HZ[0] <= winding.pwm_hz(each) <= PWM_HZ[1]]
        return [best, *(each for each in others if each != best)]

    def regulates(self, motor: Motor, blank: int, frequency: int) -> bool:
        """t_blank f_PWM V / R against the peak (DS-TMC5160 7.3.1)."""
        winding = _winding(motor)
        return winding.peak_a >= SURE * winding.lowest_current_a(blank, frequency)

    def threshold(self, rps: float, motor: Motor) -> int:
        """TPWMTHRS, as TSTEP."""
        pps = rps * motor.full_steps_a_turn * TABLE_MICROSTEPS
        return min(tstep(pps, TABLE_MICROSTEPS, motor.clock_hz), TSTEP_MAX)

    def of_velocity(self, rps: float, motor: Motor) -> float:
        """256 over TSTEP (7.4)."""
        return rps * motor.full_steps_a_turn * TABLE_MICROSTEPS * 256 / motor.clock_hz

    def rps(self, threshold: int, motor: Motor) -> float:
        """Its inverse."""
        return motor.clock_hz / threshold / TABLE_MICROSTEPS / motor.full_steps_a_turn


def _winding(motor: Motor) -> Winding:
    return Winding(
        motor.resistance_ohm,
        motor.inductance_h,
        motor.current_a,
        motor.supply_v,
        motor.clock_hz,
        irun=motor.run_scale,
        holding_torque_nm=motor.holding_torque_nm,
        rated_current_a=motor.rated_current_a,
        full_steps_per_rev=motor.full_steps_a_turn,
    )


STEALTHCHOP = StealthPlaces(
    on=Place("GCONF", "en_pwm_mode"),
    offset=Place("PWMCONF", "PWM_OFS"),
    gradient=Place("PWMCONF", "PWM_GRAD"),
    frequency=Place("PWMCONF", "pwm_freq"),
    threshold=Place("TPWMTHRS"),
    blank=Place("CHOPCONF", "tbl"),
    # With pwm_autoscale 0 it begins with what PWMCONF holds (7.4).
    tunes=(Place("PWMCONF", "pwm_autoscale"), Place("PWMCONF", "pwm_autograd")),
    # StallGuard2, full steps and CoolStep at their thresholds would end it, or change the current under way.
    fixed={
        Place("TCOOLTHRS"): 0,
        Place("THIGH"): 0,
        Place("CHOPCONF", "vhighfs"): 0,
        Place("CHOPCONF", "vhighchm"): 0,
        Place("COOLCONF", "semin"): 0,
    },
    amplitude="PWM_SCALE",
    now="PWM_SCALE_SUM",
    added="PWM_SCALE_AUTO",
    offset_auto="PWM_OFS_AUTO",
    gradient_auto="PWM_GRAD_AUTO",
    calculator=SheetCalculator(),
)
