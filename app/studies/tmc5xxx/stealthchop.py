"""Where a TMC5xxx keeps its StealthChop (DS-TMC5160 6.3, 7; DS-TMC5130 7; FIELDS-TMC5240)."""

from __future__ import annotations

from ...calc.tmc5xxx.chopper import Winding
from ...calc.tmc5xxx.chopper_hints import hints
from ...calc.units.tmc5xxx_times import TABLE_MICROSTEPS, TSTEP_MAX, tstep
from ..field_settings import Place
from ..stealthchop.setting import Motor, StealthPlaces

PWM_HZ = 20e3, 50e3
"""What suits most motors (DS-TMC5160 7.2)."""


class SheetCalculator:
    """The calculator of the page Current and chopper."""

    def first(self, model: str, motor: Motor) -> tuple[int | None, int | None, int]:
        """374 R I / V; C_BEMF 2 pi fCLK 1.46 / (V MSPR); nearest to the middle of 20 to 50 kHz (DS-TMC5160 7.4)."""
        found = {each.field: each.value for each in hints(model, _winding(motor)).settings}
        if "PWM_OFS" not in found:
            return None, None, found["pwm_freq"]
        return found["PWM_OFS"], found.get("PWM_GRAD"), found["pwm_freq"]

    def suits(self, motor: Motor, frequency: int) -> bool:
        """20 to 50 kHz."""
        return PWM_HZ[0] <= _winding(motor).pwm_hz(frequency) <= PWM_HZ[1]

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
