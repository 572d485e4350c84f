"""The modules that speak TMCL, as the catalog lists them."""

from __future__ import annotations

from ..entry import Model
from . import pd42
from .tmcm1161 import TMCM1161

FAMILY = "tmcl"

MODELS = (
    Model(
        "pd42-1241",
        FAMILY,
        "PD42-1241",
        "motor, driver and encoder in one; TMCL over USB, RS485, CAN",
        "a module with parameters",
        pd42.AXES,
        pd42.PD42,
        clock_hz_default=pd42.CLOCK_HZ,
        clock_hz_max=pd42.CLOCK_HZ,
        capabilities=frozenset(
            {"parameters", "motion", "current", "encoder", "stallguard", "home_switch", "store", "programs"}
        ),
        wires=frozenset({"emulator", "serial", "tcp", "can"}),
        current_scale="full_scale",
        kind="module",
        datagram_bits=0,
    ),
    Model(
        "tmcm-1161",
        FAMILY,
        "TMCM-1161",
        "controller and driver to 2.8 A for the back of a motor, with an encoder; TMCL over USB, RS485, RS232",
        "a module with parameters",
        TMCM1161.axes,
        TMCM1161.table,
        clock_hz_default=TMCM1161.clock_hz,
        clock_hz_max=TMCM1161.clock_hz,
        capabilities=frozenset(
            {"parameters", "motion", "current", "encoder", "stallguard", "home_switch", "store", "programs"}
        ),
        wires=frozenset({"emulator", "serial", "tcp"}),
        current_scale="full_scale",
        kind="module",
        datagram_bits=0,
    ),
)
