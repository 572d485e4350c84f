"""The composition root: the only place that knows every room."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

from fastapi import FastAPI
from pydantic import ValidationError

from app import demo
from app.api.app import make_app
from app.api.bench import Bench
from app.api.routes.ports import serial_ports
from app.api.schemas import Port
from app.calc.ramp import RampParameters, exact_ramp
from app.clock import Clock, WallClock
from app.devices.device import Device
from app.devices.manager import DeviceManager
from app.emulators.build import build_emulator, warm_up
from app.emulators.options import EmulatorOptions
from app.links.emulator import EmulatorPort
from app.links.errors import BenchError, UsageError
from app.links.port import FramePort
from app.links.registry import Link, tcp_factory
from app.settings import Settings
from app.store.connections import ConnectionStore
from app.store.saver import Saver
from app.telemetry.hub import TelemetryHub
from app.tuning.procedures import Procedures

log = logging.getLogger("stepscope")

PATIENCE_S = 1.5
"""A start that takes longer than this says why [s]."""
STOP_WITHIN_S = 0.5
"""How long stopping the motors may hold up the end of the program [s]."""


def create_app(
    settings: Settings | None = None,
    clock: Clock | None = None,
    list_serial_ports: Callable[[], list[Port]] = serial_ports,
) -> FastAPI:
    """The whole program as an ASGI application. Connections open when its lifespan begins.

    `clock` is what a test owns; `list_serial_ports` what a machine without ports can say instead.
    """
    settings, clock = settings or Settings(), clock or WallClock()
    hub = TelemetryHub(clock, settings.history_minutes)
    store = ConnectionStore(settings.data_dir)
    kinds = {"emulator": emulator_port, "tcp": tcp_factory}
    opened = asyncio.Event()

    def changed() -> None:
        hub.sync(manager.devices)
        if opened.is_set():  # what comes from the disk need not go back there
            saver.request()

    manager = DeviceManager(kinds, clock, on_change=changed)
    saver = Saver(store, manager.configs)
    bench = Bench(settings, clock, manager, hub, Procedures(clock), list_serial_ports)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        saved = store.load()
        for warning in saved.warnings:
            log.warning("%s", warning)
        compiling = asyncio.create_task(asyncio.to_thread(compile_kernels))
        if not (await asyncio.wait({compiling}, timeout=PATIENCE_S))[0]:
            log.warning("the first start compiles the emulators, which takes some 15 s; later ones find it done")
        await compiling
        for config in saved.configs:
            # Not waited for: hardware that is off must not keep the page from coming up.
            await manager.add(config, wait=False)
        if settings.demo or (settings.demo is None and not saved.configs):
            await demo.add(manager)
        opened.set()
        try:
            yield
        finally:
            opened.clear()
            await stop_motors(bench)
            await hub.close()
            await manager.close()
            await saver.close()

    return make_app(bench, lifespan)


def emulator_port(model: str, link: Link, clock: Clock) -> FramePort:
    """`{"kind": "emulator", ...}`: a chip of its own behind a port of its own. Raises UsageError."""
    try:
        options = EmulatorOptions.model_validate({name: value for name, value in link.items() if name != "kind"})
    except ValidationError as error:
        raise UsageError(f"the emulator's options do not fit: {error}") from error
    return EmulatorPort(build_emulator(model, clock, options))


def bench_of(app: FastAPI) -> Bench:
    """The bench that `create_app` put together."""
    bench = app.state.bench
    assert isinstance(bench, Bench)
    return bench


def compile_kernels() -> None:
    """Compile what numba has to compile, or load it from its cache: else the first move would wait for it."""
    warm_up()
    exact_ramp(RampParameters(v_min=1, v_max=1000, a_max=100, ramp_div=5, pulse_div=5, pmul=100, pdiv=4), 1000, 10)


async def stop_motors(bench: Bench) -> None:
    """Slow down every motor of a connected device that moves: before the server goes.

    A device that does not answer within `STOP_WITHIN_S` is given up; a message tells of it.
    """
    try:
        async with asyncio.timeout(STOP_WITHIN_S):
            await bench.procedures.close()
            connected = [device for device in bench.manager.devices if device.state == "connected"]
            await asyncio.gather(*(_stop_moving(device) for device in connected))
    except TimeoutError:
        log.warning("not every motor was stopped: a device did not answer in %g s", STOP_WITHIN_S)


async def _stop_moving(device: Device) -> None:
    try:
        moving = [axis.index for axis in device.axes if (await device.axis_state(axis.index)).moving]
        for outcome in await device.stop_axes(moving) if moving else ():
            if outcome.problem is not None:
                raise outcome.problem
    except BenchError as error:
        log.warning("the motors of %s were not stopped: %s", device.name, error)
