"""Which procedure of its own each family has: its reference search, and the calibration of a closed loop."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

from ..clock import Clock
from ..devices.core.device import Device
from ..errors import WrongState
from .closed_loop import Calibration
from .search import Search, SearchWanted, Switch
from .tmc5xxx.search import SwitchSearch
from .tmc428.search import ReferenceSearch
from .tmc4361.closed_loop import ClosedLoopCalibration
from .tmc4361.search import LatchSearch
from .tmcl.search import ModuleSearch

MakeSearch: TypeAlias = Callable[[Device, int, Clock, SearchWanted], Search]


def _by_switch(kind: Callable[[Device, int, Clock, Switch, float | None, int | None], Search]) -> MakeSearch:
    return lambda device, axis, clock, wanted: kind(
        device, axis, clock, wanted.switch, wanted.velocity_pps, wanted.max_travel
    )


def _by_module(device: Device, axis: int, clock: Clock, wanted: SearchWanted) -> Search:
    speed_pps = wanted.search_speed_pps or wanted.velocity_pps
    return ModuleSearch(device, axis, clock, wanted.mode, speed_pps, wanted.switch_speed_pps, wanted.max_travel)


SEARCHES: Mapping[str, MakeSearch] = {
    "tmc428": _by_switch(ReferenceSearch),
    "tmc4361": _by_switch(LatchSearch),
    "tmc5xxx": _by_switch(SwitchSearch),
    "tmcl": _by_module,
}


CALIBRATIONS = {"tmc4361": ClosedLoopCalibration}


def search_of(device: Device, axis: int, clock: Clock, wanted: SearchWanted) -> Search:
    """The reference search of its family. Raises WrongState, OutOfRange for what cannot be."""
    search = SEARCHES.get(device.family.family)
    if search is None:
        raise WrongState(
            f"how a {device.family.title} searches its reference is not known here",
            "start its own search from the console (RFS START), or set its position",
        )
    return search(device, axis, clock, wanted)


def calibration_of(
    device: Device, axis: int, clock: Clock, velocity_pps: float, settle_s: float, *, switch_on: bool
) -> Calibration:
    """The calibration of its closed loop. Raises WrongState where it has none, OutOfRange."""
    index, kind = device.axis(axis).index, CALIBRATIONS.get(device.family.family)
    if kind is None:
        raise WrongState(f"a {device.family.title} has no closed loop", "a TMC4361 has one")
    return kind(device, index, clock, velocity_pps, settle_s, switch_on=switch_on)
