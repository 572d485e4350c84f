"""Settings of the chopper to begin with, for a motor at its supply: each with what it means, its reason and source.

A starting point, not an end: the sheets go on with an oscilloscope and an ear (application note AN-SPREADCYCLE).

Sources: as in `chopper`.
"""

from __future__ import annotations

import math

from ..units.tmc5xxx_times import TABLE_MICROSTEPS, TSTEP_MAX, tstep
from .chopper import BLANK_CLOCKS, Winding
from .chopper_notes import OWN, SHEETS, ChopperChoices, Figure, Hints, Setting, Sheet, picked
from .stealth import stealthchop

BLANK_GOAL_S = 2e-6
"""Blank times of 1 to 2 us are where to begin (AN-SPREADCYCLE)."""
HYSTERESIS_USUAL = 4
"""Fits most motors (DS-TMC5160 8.1)."""
HYSTERESIS_MOST = 16
HEARD_HZ = 16e3
HOT_HZ = 50e3
"""Between these a chopper is not heard and loses little (DS-TMC5160 8; DS-TMC5031 7)."""


def hints(model: str, winding: Winding, wishes: ChopperChoices | None = None) -> Hints:
    """Everything that can be said of a motor at a chip.

    Raises ValueError for another chip, and for TOFF 1 with the shortest blank time, which the chips cannot do.
    """
    if model not in SHEETS:
        raise ValueError(f"model is one of {', '.join(SHEETS)}, not {model}")
    sheet, wishes, found = SHEETS[model], wishes or ChopperChoices(), Hints()
    _spreadcycle(found, sheet, winding, wishes)
    if sheet.stealth != "none":
        stealthchop(found, sheet, winding, wishes)
    _limits(found, sheet, winding, wishes)
    _of_supply(found, winding)
    return found


def split(hysteresis: int) -> tuple[int, int]:
    """HSTRT and HEND, as in their fields, for an effective hysteresis at its start, -2..16.

    As much as can be in HSTRT, from where the chip counts down to HEND within a cycle: that keeps the frequency up
    where the supply is short (DS-TMC5160 8.1, second example). Raises ValueError outside.
    """
    if not -2 <= hysteresis <= HYSTERESIS_MOST:
        raise ValueError(f"an effective hysteresis is -2 to 16, got {hysteresis}")
    start = min(8, hysteresis + 3)
    return start - 1, hysteresis - start + 3


def _spreadcycle(found: Hints, sheet: Sheet, winding: Winding, wishes: ChopperChoices) -> None:
    tbl = _blank(found, sheet, winding, wishes)
    toff = _off(found, sheet, winding, wishes, tbl)
    hysteresis = _hysteresis(found, sheet, winding, wishes, tbl, toff)
    _frequencies(found, sheet, winding, tbl, toff, hysteresis)


def _blank(found: Hints, sheet: Sheet, winding: Winding, wishes: ChopperChoices) -> int:
    tbl, chosen = picked(wishes.tbl, lambda: blank_setting(winding.clock_hz))
    meaning = f"{BLANK_CLOCKS[tbl]} clocks, {winding.blank_s(tbl) * 1e6:.3g} us"
    reason = (
        "the longest blank time of up to 2 us: short enough for small currents, long enough for the ringing at the "
        "sense resistor of most boards"
    )
    found.settings.append(
        Setting("CHOPCONF", "tbl", tbl, None, meaning, reason, f"AN-SPREADCYCLE; {sheet.spreadcycle}", chosen)
    )
    return tbl


def _off(found: Hints, sheet: Sheet, winding: Winding, wishes: ChopperChoices, tbl: int) -> int:
    exact = winding.toff(wishes.chopper_hz)
    toff, chosen = picked(wishes.toff, lambda: min(max(round(exact), 1 if tbl else 2), 15))
    if toff == 1 and tbl == 0:
        raise ValueError("TOFF 1 takes a blank time of 24 clocks or more: tbl 1 to 3")
    meaning = f"{24 + 32 * toff} clocks, {winding.off_s(toff) * 1e6:.3g} us"
    reason = f"two slow decays for half of a cycle at {wishes.chopper_hz / 1e3:g} kHz"
    found.settings.append(Setting("CHOPCONF", "toff", toff, exact, meaning, reason, sheet.spreadcycle, chosen))
    return toff


def _hysteresis(found: Hints, sheet: Sheet, winding: Winding, wishes: ChopperChoices, tbl: int, toff: int) -> int:
    exact = winding.hysteresis(tbl, toff)
    hysteresis, chosen = picked(
        wishes.hysteresis, lambda: min(max(math.ceil(exact - 1e-9), HYSTERESIS_USUAL), HYSTERESIS_MOST)
    )
    start, end = split(hysteresis)
    reason = (
        f"the band has to hold the ripple of the blank time and of both slow decays, {exact:.3g} of hysteresis, and "
        f"{HYSTERESIS_USUAL} suits most motors; as much of it as can be in HSTRT"
    )
    source = f"{sheet.spreadcycle} (words), {OWN} (numbers); AN-SPREADCYCLE"
    meanings = {"hstrt": f"+{start + 1}", "hend": f"{end - 3:+d}, effective {hysteresis} at the start"}
    for name, value in (("hstrt", start), ("hend", end)):
        found.settings.append(Setting("CHOPCONF", name, value, exact, meanings[name], reason, source, chosen))
    if exact > HYSTERESIS_MOST:
        found.warnings.append(
            f"the ripple takes a hysteresis of {exact:.3g}, and {HYSTERESIS_MOST} is the most: less TOFF or TBL, a "
            "lower supply or a motor of more inductance"
        )
    if winding.irun == 31 and hysteresis == HYSTERESIS_MOST:
        found.warnings.append("with the greatest hysteresis IRUN of 30 or less leaves the sine its shape")
    return hysteresis


def _frequencies(found: Hints, sheet: Sheet, winding: Winding, tbl: int, toff: int, hysteresis: int) -> None:
    def say(name: str, label: str, value: float, unit: str, reason: str, source: str = OWN) -> None:
        found.figures.append(Figure(name, label, value, unit, reason, source))

    say("blank_ripple", "ripple of the blank time", winding.blank_ripple_a(tbl), "A", "V t_blank / L")
    decay = winding.decay_ripple_a(toff)
    say("decay_ripple", "ripple of both slow decays", decay, "A", "R I 2 t_off / L, at the peak")
    band = winding.band_a(hysteresis)
    say("hysteresis_band", "band of the hysteresis", band, "A", "hysteresis / 248 of the peak at full scale")
    limit = winding.highest_chopper_hz(tbl, toff)
    shortest = "two slow decays and two blank times are the shortest cycle"
    say("chopper_limit", "chopper frequency at most", limit, "Hz", shortest, sheet.spreadcycle)
    estimate = winding.chopper_hz(tbl, toff, hysteresis)
    begin = "with the hysteresis at its start, at the current's peak; decrement raises it"
    say("chopper_frequency", "chopper frequency at rest", estimate, "Hz", begin)
    if 0 < estimate < HEARD_HZ:
        found.warnings.append(f"the chopper may be heard: about {estimate / 1e3:.3g} kHz; less TOFF or hysteresis")
    if estimate > HOT_HZ:
        found.warnings.append(
            f"about {estimate / 1e3:.3g} kHz of chopper heat driver and motor: more TOFF or hysteresis"
        )


def blank_setting(clock_hz: float) -> int:
    """TBL to begin with: the longest blank time of up to 2 us, or the shortest there is."""
    return max(
        (n for n, clocks in enumerate(BLANK_CLOCKS) if clocks / clock_hz <= BLANK_GOAL_S * (1 + 1e-9)), default=0
    )


def _limits(found: Hints, sheet: Sheet, winding: Winding, wishes: ChopperChoices) -> None:
    least = "of many motors the back-EMF is too small below a turn a second: where TCOOLTHRS or VCOOLTHRS may begin"
    _speeds(
        found,
        "stallguard_least",
        "speed from which StallGuard and CoolStep work",
        2 * math.pi,
        winding,
        wishes,
        least,
        "DS-TMC5160 13.5",
    )
    if winding.back_emf is None:
        return
    say = found.figures.append
    say(
        Figure(
            "back_emf",
            "back-EMF constant, RMS of a coil",
            winding.back_emf,
            "V s/rad",
            "holding torque over twice the rated current",
            "DS-TMC5160 7.4",
        )
    )
    current = winding.current_limit_rad_s()
    if current is not None:
        _speeds(
            found,
            "current_limit",
            "speed up to which the current holds",
            current,
            winding,
            wishes,
            "(R I + k w)^2 + (N w L I)^2 = V^2 at the current's peak, under full load",
            OWN,
        )
    stealth = winding.stealth_limit_rad_s()
    if stealth is not None and sheet.stealth in ("gradient", "tuned"):
        _speeds(
            found,
            "stealthchop_limit",
            "speed at which StealthChop's amplitude is at its end",
            stealth,
            winding,
            wishes,
            "where amplitude at rest and gradient add up to 255",
            sheet.stealthchop,
        )


def _speeds(
    found: Hints,
    name: str,
    label: str,
    rad_s: float,
    winding: Winding,
    wishes: ChopperChoices,
    reason: str,
    source: str,
) -> None:
    turns = rad_s / (2 * math.pi)
    pps = turns * winding.full_steps_per_rev * wishes.microsteps
    clocks = tstep(pps, wishes.microsteps, winding.clock_hz)
    found.figures.append(Figure(name, label, pps, "pps", reason, source))
    found.figures.append(Figure(f"{name}_rpm", label, turns * 60, "rpm", reason, source))
    if clocks < TSTEP_MAX:
        found.figures.append(
            Figure(
                f"{name}_tstep",
                f"{label}, as TSTEP",
                clocks,
                "clocks",
                f"fCLK over its steps of 1/{TABLE_MICROSTEPS}",
                source,
            )
        )


def _of_supply(found: Hints, winding: Winding) -> None:
    found.figures.append(
        Figure(
            "headroom",
            "supply over the motor's voltage at rest",
            winding.headroom,
            "",
            "V / (R I): well above 1, below 25",
            "AN-SPREADCYCLE",
        )
    )
    if winding.supply_v <= winding.resistance_ohm * winding.peak_a:
        found.warnings.append("the supply cannot drive this current through the coil's resistance")
    elif winding.headroom < 2:
        found.warnings.append("the supply is below twice the motor's voltage: the chopper may become slow and audible")
    elif winding.headroom > 25:
        found.warnings.append(
            "the supply is above 25 times the motor's voltage: ripple and heat; a lower one does better"
        )
