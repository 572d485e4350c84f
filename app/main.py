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
from app.clock import Clock, WallClock
from app.devices.manager import DeviceManager
from app.emulators.build import build_emulator, warm_up
from app.emulators.options import EmulatorOptions
from app.links.emulator import EmulatorPort
from app.links.errors import UsageError
from app.links.port import FramePort
from app.links.registry import Link, tcp_factory
from app.settings import Settings
from app.store.connections import ConnectionStore
from app.store.saver import Saver
from app.telemetry.hub import TelemetryHub
from app.tuning.procedures import Procedures

log = logging.getLogger("stepscope")


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
        # In a thread, because it takes seconds on the first start of an installation (milliseconds later).
        await asyncio.to_thread(warm_up)
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


async def stop_motors(bench: Bench) -> None:
    """Slow every moving motor down to a stop: before the server goes. What fails is told, and holds nothing up."""
    await bench.procedures.close()
    for outcome in await bench.manager.stop_all():
        if not outcome.ok:
            log.warning("%s axis %d was not stopped: %s", outcome.device, outcome.axis, outcome.problem)
