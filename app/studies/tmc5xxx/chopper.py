"""Where a TMC5xxx keeps its choppers (DS-TMC5160 6.5, 7, 8; DS-TMC5072 for VCOOLTHRS)."""

from __future__ import annotations

from ...calc.tmc5xxx.chopper import BLANK_CLOCKS, Winding
from ...calc.tmc5xxx.chopper_hints import hints, split
from ..chopper.setting import ChopperPlaces, ChopperSetting, Coil
from ..field_settings import Place


class SheetCalculator:
    """The calculator of the page Current and chopper. `driver` is the chip that drives the motor; "": the model."""

    def __init__(self, driver: str = "") -> None:
        self._driver = driver

    def first(self, model: str, coil: Coil) -> ChopperSetting:
        """Blank time of up to 2 us, slow decay for half a cycle, the hysteresis that holds the ripple of both."""
        found = hints(self._driver or model, _winding(coil))
        hysteresis = found.value("hstrt") + 1 + found.value("hend") - 3
        return ChopperSetting(found.value("toff"), found.value("tbl"), hysteresis)

    def chopper_hz(self, coil: Coil, setting: ChopperSetting) -> float:
        """Estimated [Hz]."""
        return _winding(coil).chopper_hz(setting.blank, setting.off, setting.hysteresis)

    def blank_s(self, coil: Coil, blank: int) -> float:
        """TBL's clocks [s]."""
        return BLANK_CLOCKS[blank] / coil.clock_hz

    def ripples(self, coil: Coil, off: int, blank: int) -> tuple[float, float]:
        """Both over what one hysteresis is."""
        winding = _winding(coil)
        band_a = winding.band_a(1)
        return winding.blank_ripple_a(blank) / band_a, winding.decay_ripple_a(off) / band_a

    def split(self, hysteresis: int) -> tuple[int, int]:
        """As much as can be in HSTRT."""
        start, end = split(hysteresis)
        return start + 1, end - 3


def _winding(coil: Coil) -> Winding:
    return Winding(
        coil.resistance_ohm, coil.inductance_h, coil.current_a, coil.supply_v, coil.clock_hz, irun=coil.run_scale
    )


CHOPPER = ChopperPlaces(
    off=Place("CHOPCONF", "toff"),
    blank=Place("CHOPCONF", "tbl"),
    start=Place("CHOPCONF", "hstrt"),
    end=Place("CHOPCONF", "hend"),
    blanks=len(BLANK_CLOCKS),
    # StealthChop off at every speed, and CoolStep: it would change the current under way.
    fixed={
        Place("CHOPCONF", "chm"): 0,
        Place("CHOPCONF", "vhighfs"): 0,
        Place("CHOPCONF", "vhighchm"): 0,
        Place("COOLCONF", "semin"): 0,
        Place("GCONF", "en_pwm_mode"): 0,
        Place("VCOOLTHRS"): 0,
    },
    calculator=SheetCalculator(),
)
