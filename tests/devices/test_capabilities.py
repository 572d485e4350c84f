"""The catalog's capabilities: for every model exactly what its driver can, found by asking the driver."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Awaitable, Callable
from dataclasses import replace
from typing import get_args

import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.core.capabilities import (
    DriverChainRam,
    EventLog,
    LatchedFlags,
    MicrostepRam,
    MslutTable,
    ParameterStore,
    PositionFromEncoder,
    ProgramMemory,
    StallStop,
    StartWire,
    TmclCommands,
)
from app.devices.core.cover import CoverCarrier
from app.devices.core.device import Device
from app.devices.core.register_file import RegisterFile
from app.devices.families import family_of
from app.devices.manager import DeviceChange
from app.errors import UsageError, WrongState
from app.procedures.procedures import Procedures
from app.registers.capabilities import TITLES, Capability
from app.registers.catalog import MODELS, Model

from .limits.harness import Bench, bench

DRIVER_MICROSTEPS = 32
"""Unlike every default, so that a driver which reckons with it is found out."""


async def _does_it(do: Callable[[], Awaitable[object]]) -> bool:
    try:
        await do()
    except WrongState:
        return False
    return True


def _has_row(model: Model, *names: str) -> bool:
    """Of its own, or of the driver chip that a module's parameters set."""
    known = {row.name for row in model.table} | {row.driver.name for row in model.table if row.driver is not None}
    return set(names) <= known


def _every_axis(device: Device, quantity: str) -> bool:
    offered = {channel.name for channel in device.telemetry.channels()}
    there = [f"{quantity}.{axis.index}" in offered for axis in device.axes]
    assert all(there) or not any(there), "one axis has it, another not: it is no capability of the model then"
    return all(there)


def _keeps_current_limits(model: Model) -> bool:
    limits = AxisLimits(current_max_a=1.0, sense_resistor_ohm=0.1, current_full_scale_a=2.0)
    for only in ("sense_resistor_ohm", "current_full_scale_a"):
        try:
            replace(limits, **{only: None}).require_model(model.name)
        except UsageError:
            continue
        return True
    return False


async def _can_calibrate(made: Bench) -> bool:
    """Whether a closed loop is refused as something that the device cannot, or begun (and refused later, or ended)."""
    procedures = Procedures(made.clock)
    try:
        procedures.start_calibration(made.device, 0)
    except WrongState:
        return False
    await procedures.close()
    return True


async def _takes_driver_microsteps(made: Bench) -> bool:
    settings = [replace(axis, driver_microsteps=DRIVER_MICROSTEPS) for axis in made.device.config.axes]
    device = await made.manager.edit(made.device.id, DeviceChange(axes=tuple(settings)))
    await device.identity.refresh()
    return all(axis.microsteps_per_full_step == DRIVER_MICROSTEPS for axis in device.axes)


async def can(made: Bench) -> set[Capability]:
    device = made.device
    model = device.family
    axes = [axis.index for axis in device.axes]
    shown: dict[Capability, bool] = {
        "registers": device.part(RegisterFile) is not None,
        "parameters": device.part(TmclCommands) is not None,
        "motion": bool(device.axes),
        "ramp.pmul": any("pmul" in (row.name.lower(), *(f.name.lower() for f in row.fields)) for row in model.table),
        "ramp.s": _has_row(model, "BOW1", "BOW2", "BOW3", "BOW4"),
        "ramp.sixpoint": _has_row(model, "VSTART", "A1", "V1", "AMAX", "VMAX", "DMAX", "D1", "VSTOP"),
        "microsteps.ram": await _does_it(lambda: device.need(MicrostepRam).read_microstep_table()),
        "microsteps.mslut": await _does_it(lambda: device.need(MslutTable).read_mslut()),
        "driver_chain": await _does_it(lambda: device.need(DriverChainRam).read_driver_chain()),
        "step_dir": await _takes_driver_microsteps(made),
        "chopper": _has_row(model, "CHOPCONF", "IHOLD_IRUN"),
        "current": _keeps_current_limits(model),
        "current.ramp": _has_row(model, "CURRENT_CONF", "SCALE_VALUES"),
        "current.scale": _has_row(model, "SGCSCONF", "CHOPCONF"),
        "encoder": _every_axis(device, "encoder_position"),
        "closed_loop": await _can_calibrate(made),
        "serial_encoder": _has_row(model, "ENC_IN_DATA", "ENC_OUT_DATA"),
        "driver_sync": _has_row(model, "CHOPSYNC_DIV", "DC_VEL"),
        "stallguard": _every_axis(device, "load_value"),
        "stallguard.behind": device.part(StallStop) is not None and device.part(CoverCarrier) is not None,
        "start_pin": device.part(StartWire) is not None,
        "home_switch": _every_axis(device, "switch_home") or _every_axis(device, "switch_reference"),
        "input_filters": _has_row(model, "INPUT_FILT_CONF"),
        "events": device.part(EventLog) is not None,
        "flags": device.part(LatchedFlags) is not None,
        "position_compare": any(device.counter.compare_register(axis) is not None for axis in axes),
        "position_latch": all(device.counter.latch_register(axis) is not None for axis in axes),
        "store": device.part(ParameterStore) is not None,
        "programs": device.part(ProgramMemory) is not None,
        "step_input": not _every_axis(device, "position"),
        "own_velocity": any(row.name == "VACTUAL" and row.access.writable for row in model.table),
    }
    assert set(shown) == set(get_args(Capability)), "a capability that no driver is asked for may be a lie"
    return {capability for capability, there in shown.items() if there}


@pytest.mark.parametrize("name", MODELS)
async def test_a_model_can_what_its_driver_can(name: str) -> None:
    async with bench(name) as made:
        assert await can(made) == MODELS[name].capabilities


@pytest.mark.parametrize("name", MODELS)
async def test_only_who_has_an_encoder_takes_a_position_from_it(name: str) -> None:
    async with bench(name) as made:
        device = made.device
        if MODELS[name].can("encoder"):
            assert device.part(PositionFromEncoder) is not None
        else:
            assert not await _does_it(lambda: device.need(PositionFromEncoder).position_from_encoder(0))


@pytest.mark.parametrize("name", MODELS)
def test_a_current_scale_is_what_the_limits_ask_for(name: str) -> None:
    model = MODELS[name]
    assert (model.current_scale != "") == model.can("current")
    enough = {
        "sense_resistor": AxisLimits(current_max_a=1.0, sense_resistor_ohm=0.1),
        "full_scale": AxisLimits(current_max_a=1.0, current_full_scale_a=2.0),
    }
    if model.current_scale:
        enough[model.current_scale].require_model(name)
        with pytest.raises(UsageError):
            AxisLimits(current_max_a=1.0).require_model(name)


@pytest.mark.parametrize("name", MODELS)
def test_a_family_is_the_folder_of_its_tables_and_of_its_driver(name: str) -> None:
    model = MODELS[name]
    assert model in importlib.import_module(f"app.registers.{model.family}.models").MODELS
    assert family_of(name).name == model.family
    assert inspect.getmodule(family_of(name).compose).__name__ == f"app.devices.{model.family}.family"  # type: ignore[union-attr]
    assert model.clock_hz_min < model.clock_hz_default <= model.clock_hz_max


def test_every_capability_has_a_title_and_somebody_who_has_it() -> None:
    assert set(TITLES) == set(get_args(Capability))
    assert set().union(*(model.capabilities for model in MODELS.values())) == set(get_args(Capability))
