"""Getting a driver to run after power-on: who sets its microsteps, currents, and the chopper that lets them flow.

Chopper and StealthChop are as after a reset, which suits most motors (DS-TMC2209 5.5): toff 3, hstrt 5, hend 0. A chip
that resets to no hysteresis gets what the maker's host code begins with (NOTES-TMC5XXX 9): toff 5, hstrt 5, hend 3.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...calc.families import CHIPS
from ...calc.tmc5xxx.coil import CurrentStage, range_share
from ...errors import OutOfRange, UsageError
from ...registers.model import Register
from ..core.axis_limits import full_scale_figures
from ..core.device import Device
from ..core.results import WriteItem
from ..core.start_up import HOLD_SHARE, AxisStartUp, StartPlan, scale_of
from .limits import full_scale_a

TBL = 2
IRUN = 16
HOLD_DELAY, TPOWERDOWN = 1, 20
MICROSTEPS = (256, 128, 64, 32, 16, 8, 4, 2, 1)
"""By CHOPCONF.mres."""
DEFAULT_MICROSTEPS = 256
MOST = 31


async def plan(device: Device, wanted: Sequence[AxisStartUp]) -> StartPlan:
    """What the axis needs after power-on, in its order. Raises UsageError for an encoder or a ramp: it has none."""
    items: list[WriteItem] = []
    for one in wanted:
        if one.figures.counts_per_rev:
            raise UsageError(f"a {device.family.title} reads no encoder: leave counts_per_rev out")
        for name in ("velocity_pps", "acceleration_pps2", "deceleration_pps2"):
            if getattr(one.figures, name) is not None:
                raise UsageError(f"a {device.family.title} has no ramp: leave {name} out")
        microsteps = one.microsteps(DEFAULT_MICROSTEPS, MICROSTEPS)
        irun, ihold, vsense, current_range = _currents(device.model, one)
        vactual = device.family.table.find("VACTUAL", one.axis)
        by_register: dict[str, int | str] = {
            name: 1
            for name in ("pdn_disable", "mstep_reg_select")
            if device.family.table.get("GCONF").field_named(name) is not None
        }
        chopper = _chopper(device.family.table.get("CHOPCONF", one.axis)) | {"mres": MICROSTEPS.index(microsteps)}
        chopper |= {} if vsense is None else {"vsense": vsense}
        items += [
            *([WriteItem("VACTUAL", one.axis, 0)] if vactual is not None else []),
            *([WriteItem("GCONF", None, fields=by_register)] if by_register else []),
            WriteItem("TPOWERDOWN", one.axis, TPOWERDOWN),
            # first what makes all currents smaller: scales may be beyond a limit without it
            *([WriteItem("CHOPCONF", one.axis, fields={"vsense": 1})] if vsense else []),
            WriteItem("IHOLD_IRUN", one.axis, fields={"IHOLD": ihold, "IRUN": irun, "IHOLDDELAY": HOLD_DELAY}),
            *_ranged(one.axis, current_range),
            WriteItem("CHOPCONF", one.axis, fields=chopper),
        ]
    return StartPlan(items)


def _ranged(axis: int, current_range: int | None) -> list[WriteItem]:
    """All of a range of full scale."""
    if current_range is None:
        return []
    return [
        WriteItem("GLOBAL_SCALER", axis, 0),
        WriteItem("DRV_CONF", axis, fields={"CURRENT_RANGE": current_range}),
    ]


def _chopper(row: Register) -> dict[str, int | str]:
    """CHOPCONF's part of SpreadCycle."""
    after = row.unpack(row.reset or 0)
    toff, hstrt, hend = (3, after["hstrt"], after["hend"]) if after["hstrt"] else (5, 5, 3)
    kind: dict[str, int | str] = {"chm": 0} if "chm" in after else {}
    return {"toff": toff, "hstrt": hstrt, "hend": hend, "tbl": TBL, **kind}


def _currents(model: str, one: AxisStartUp) -> tuple[int, int, int | None, int | None]:
    """IRUN, IHOLD, vsense and range, nearest to the amperes asked for, else cautious ones. None: as it is set.

    Raises UsageError where nobody knows what a scale is in A, OutOfRange beyond full scale.
    """
    limits, run_a, ranges = one.settings.limits, one.run_current_a(), CHIPS[model].sensing.range_va
    full = full_scale_a(model, limits)
    if run_a is not None and full is not None and limits.current_full_scale_a is None:
        if run_a > full:
            raise OutOfRange("run_current_a", run_a, 0, full, "A RMS, full scale with this sense resistor")
        stage = CurrentStage(model, limits.sense_resistor_ohm)
        run, hold = stage.run_and_hold(run_a, min(one.hold_current_a(run_a), run_a))
        return run.scale, hold.scale, run.select, None
    shares = one.share_of_full_scale(full_scale_figures(model))
    if shares is not None:
        enough = (n for n in range(len(ranges)) if range_share(model, n) >= max(shares))
        current_range = next(enough, None)
        of_range = 1.0 if current_range is None else range_share(model, current_range)
        irun, ihold = (scale_of(share / of_range, MOST) for share in shares)
        return irun, ihold, None if ranges else 0, current_range
    irun = IRUN
    if limits.current_max_a is not None and full is not None:
        irun = min(irun, scale_of(limits.current_max_a / full, MOST))
    return (*one.scales(MOST, irun, int(irun * HOLD_SHARE)), None, None)
