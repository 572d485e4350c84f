"""Settings of StealthChop to begin with, and what it cannot do.

Sources: as in `chopper`.
"""

from __future__ import annotations

import math

from .chopper import AMPLITUDE_MAX, PWM_DIVIDERS, Winding
from .chopper_notes import ChopperChoices, Figure, Hints, Setting, Sheet, picked

PWM_GOAL_HZ = 35e3
"""The middle, by ratio, of the 20 to 50 kHz that suit most motors (DS-TMC5160 7.2)."""
REGULATION = 4
"""PWM_GRAD to begin with where it is how fast the amplitude is regulated (DS-TMC5130 7.2.2; DS-TMC5072 8.2.3)."""


def pwm_setting(clock_hz: float) -> int:
    """The pwm_freq to begin with: nearest, by ratio, to the middle of 20 to 50 kHz."""
    return min(range(4), key=lambda n: abs(math.log(2 * clock_hz / PWM_DIVIDERS[n] / PWM_GOAL_HZ)))


def stealthchop(found: Hints, sheet: Sheet, winding: Winding, wishes: ChopperChoices) -> None:
    source = sheet.stealthchop
    freq, chosen = picked(wishes.pwm_freq, lambda: pwm_setting(winding.clock_hz))
    found.settings.append(
        Setting(
            "PWMCONF",
            "pwm_freq",
            freq,
            None,
            f"{winding.pwm_hz(freq) / 1e3:.3g} kHz",
            "20 to 50 kHz: little ripple, and little lost in switching",
            source,
            chosen,
        )
    )
    found.settings.append(
        Setting(
            "PWMCONF",
            "pwm_autoscale",
            int(wishes.automatic),
            None,
            "regulated" if wishes.automatic else "as set",
            "the current is regulated by what is measured" if wishes.automatic else "fixed amplitudes were asked for",
            source,
            chosen=False,
        )
    )
    at_full_scale = winding.current_a * 32 / (winding.irun + 1)
    exact = winding.amplitude(at_full_scale if sheet.stealth == "tuned" else winding.current_a)
    rest = min(max(round(exact), 0), AMPLITUDE_MAX)
    if sheet.stealth == "tuned":
        _set_pwm(
            found,
            "PWM_OFS",
            rest,
            exact,
            "amplitude at rest with CS = 31",
            "374 R I / V with the current of CS = 31, since the chip scales it by CS",
            f"{source}, 7.4",
        )
    elif wishes.automatic:
        _set_pwm(
            found,
            "PWM_AMPL",
            AMPLITUDE_MAX,
            None,
            "no limit",
            "limits the amplitude when StealthChop takes over again; 255 suits low velocities, later one half to "
            "three quarters of what PWM_SCALE showed before",
            source,
        )
        _set_pwm(
            found,
            "PWM_GRAD",
            REGULATION,
            None,
            "greatest change a half wave",
            "how fast the amplitude follows: 1 slow and calm, 15 fast and maybe unstable",
            source,
        )
    else:
        _set_pwm(found, "PWM_AMPL", rest, exact, "amplitude at rest", "374 R I / V", source)
    _gradient(found, sheet, winding, wishes)
    if exact > AMPLITUDE_MAX:
        found.warnings.append("the supply is too low for this current with StealthChop, even at rest")
    tbl = found.value("tbl")
    lowest = winding.lowest_current_a(tbl, freq)
    found.figures.append(
        Figure(
            "lowest_current",
            "lowest current that StealthChop regulates",
            lowest,
            "A",
            "t_blank f_PWM V / R: the current of the shortest pulse that can be measured",
            source,
        )
    )
    if wishes.automatic and winding.current_a < lowest:
        found.warnings.append(
            f"StealthChop regulates nothing below {lowest:.3g} A here: a shorter blank time, a lower pwm_freq or supply"
        )
    if wishes.automatic and winding.irun < sheet.least_irun:
        found.warnings.append(
            f"IRUN {winding.irun} is below {sheet.least_irun}: StealthChop does not regulate by itself"
        )


def _gradient(found: Hints, sheet: Sheet, winding: Winding, wishes: ChopperChoices) -> None:
    """PWM_GRAD where it is what velocity adds to the amplitude."""
    if sheet.stealth == "fixed" and not wishes.automatic:
        _set_pwm(
            found,
            "PWM_GRAD",
            1,
            None,
            "StealthChop on",
            "only 0 or not 0 counts with fixed amplitudes",
            sheet.stealthchop,
        )
        return
    if sheet.stealth != "tuned" and (sheet.stealth == "fixed" or wishes.automatic):
        return
    exact = winding.gradient
    if exact is None:
        found.warnings.append("without a holding torque there is no PWM_GRAD: the back-EMF is not known")
        return
    _set_pwm(
        found,
        "PWM_GRAD",
        min(round(exact), AMPLITUDE_MAX),
        exact,
        "amplitude that velocity adds",
        "C_BEMF 2 pi fCLK 1.46 / (V MSPR): what the back-EMF takes is added",
        sheet.stealthchop,
    )
    if sheet.stealth == "tuned":
        _set_pwm(
            found,
            "pwm_autograd",
            int(wishes.automatic),
            None,
            "tuned in motion" if wishes.automatic else "as set",
            "the chip goes on from PWM_GRAD by itself",
            sheet.stealthchop,
            chosen=False,
        )


def _set_pwm(
    found: Hints,
    name: str,
    value: int,
    exact: float | None,
    meaning: str,
    reason: str,
    source: str,
    chosen: bool = True,
) -> None:
    found.settings.append(Setting("PWMCONF", name, value, exact, meaning, reason, source, chosen))
