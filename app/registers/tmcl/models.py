"""The modules that speak TMCL, as the catalog lists them."""

from __future__ import annotations

from functools import partial

from ..capabilities import Capability
from ..entry import Model
from . import pd42
from .tmcm1161 import TMCM1161

FAMILY = "tmcl"

_CAPABILITIES: frozenset[Capability] = frozenset(
    {"parameters", "motion", "current", "encoder", "stallguard", "home_switch", "store", "programs"}
)
_module = partial(
    Model,
    family=FAMILY,
    description="a module with parameters",
    current_scale="full_scale",
    kind="module",
    datagram_bits=0,
)

MODELS = (
    _module(
        "pd42-1241",
        title="PD42-1241",
        summary="motor, driver and encoder in one; TMCL over USB, RS485, CAN",
        axes=pd42.AXES,
        table=pd42.PD42,
        clock_hz_default=pd42.CLOCK_HZ,
        clock_hz_max=pd42.CLOCK_HZ,
        capabilities=_CAPABILITIES | {"ramp.sixpoint", "chopper"},
        driver="tmc5160",
        wires=frozenset({"emulator", "serial", "tcp", "can"}),
    ),
    _module(
        "tmcm-1161",
        title="TMCM-1161",
        summary="controller and driver to 2.8 A for the back of a motor, with an encoder; TMCL over USB, RS485, RS232",
        axes=TMCM1161.axes,
        table=TMCM1161.table,
        clock_hz_default=TMCM1161.clock_hz,
        clock_hz_max=TMCM1161.clock_hz,
        capabilities=_CAPABILITIES,
        wires=frozenset({"emulator", "serial", "tcp"}),
    ),
)
