"""Getting such a driver to run after power-on: all of its registers, for none can be read."""

from __future__ import annotations

from collections.abc import Sequence

from ....calc.tmc5xxx.coil import select_share
from ....errors import OutOfRange, UsageError
from ...core.axis_limits import full_scale_figures
from ...core.cover import COVER
from ...core.device import Device
from ...core.results import WriteItem
from ...core.start_up import AxisStartUp, StartPlan, scale_of
from ..limits import full_scale_a
from .limits import SCALES

MICROSTEPS = (256, 128, 64, 32, 16, 8, 4, 2, 1)
"""By DRVCTRL.mres."""
CHOPPER: dict[str, int | str] = {
    "toff": 5,
    "hstrt": 3,
    "hend": 6,
    "tbl": 2,
    "HDEC": 0,
    "chm": 0,
    "rndtf": 0,
}
"""SpreadCycle as the maker's evaluation board begins (EVAL-2660: 0x91935)."""
CAUTIOUS = 7
"""Current scale where nobody says any: a quarter."""
LOAD_AND_SCALE = 2
"""RDSEL."""


async def plan(device: Device, wanted: Sequence[AxisStartUp]) -> StartPlan:
    """What the axis needs, in its order: the bridges last. Raises UsageError for an encoder or a ramp: it has none."""
    items: list[WriteItem] = []
    behind = device.link.get("kind") == COVER
    for one in wanted:
        if one.figures.counts_per_rev:
            raise UsageError(f"a {device.family.title} reads no encoder: leave counts_per_rev out")
        for name in ("velocity_pps", "acceleration_pps2", "deceleration_pps2", "hold_current_a", "hold_scale"):
            if getattr(one.figures, name) is not None:
                raise UsageError(f"a {device.family.title} has no such thing: leave {name} out")
        scale, vsense = _current(device.model, one)
        items += [
            WriteItem(
                "DRVCONF",
                None,
                fields={"RDSEL": LOAD_AND_SCALE, "vsense": vsense, "SDOFF": int(behind), "TST": 0, "DISS2G": 0},
            ),
            *([] if behind else [WriteItem("DRVCTRL", one.axis, _mres(one))]),
            WriteItem("SMARTEN", one.axis, 0),
            WriteItem("SGCSCONF", one.axis, fields={"CS": scale, "sgt": 5, "sfilt": 1}),
            WriteItem("CHOPCONF", one.axis, fields=CHOPPER),
        ]
    return StartPlan(items)


def _mres(one: AxisStartUp) -> int:
    """DRVCTRL for steps, interpolated."""
    return MICROSTEPS.index(one.microsteps(16, MICROSTEPS)) | 1 << 9


def _current(model: str, one: AxisStartUp) -> tuple[int, int]:
    """CS and vsense: nearest below the amperes asked for, else a cautious scale. Raises OutOfRange above full scale."""
    limits, run_a = one.settings.limits, one.run_current_a()
    full = full_scale_a(model, limits)
    if run_a is not None and full is not None:
        if run_a > full:
            raise OutOfRange("run_current_a", run_a, 0, full, "A RMS, full scale of this axis")
        select = int(run_a <= full * select_share(model, 1))
        return scale_of(run_a / (full * select_share(model, select)), SCALES - 1), select
    if run_a is not None:
        one.no_amperes(full_scale_figures(model))
    asked = one.figures.run_scale
    if asked is not None and not 0 <= asked < SCALES:
        raise OutOfRange("run_scale", asked, 0, SCALES - 1, "steps of this chip's current scale")
    if asked is not None:
        return asked, 0
    return int(one.choose("run_scale", _within(limits.current_max_a, full), f"of {SCALES - 1}", "a cautious scale")), 0


def _within(limit_a: float | None, full_a: float | None) -> int:
    """The cautious scale, or the greatest within the soft limit."""
    if limit_a is None or full_a is None:
        return CAUTIOUS
    return min(CAUTIOUS, scale_of(limit_a / full_a, SCALES - 1))
