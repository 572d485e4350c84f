"""The composition root: the only place that knows every room."""

from __future__ import annotations

import asyncio
import logging
import re
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

from fastapi import FastAPI
from pydantic import ValidationError

from . import __version__, demo
from .api.access.tokens import Tokens
from .api.app import make_app
from .api.conditions.pages import Pages
from .api.health.vitals import Vitals
from .api.http.problems import findings
from .api.http.sessions import Sessions
from .api.links.port_routes import serial_ports
from .api.register_maps.shelf import MapShelf
from .api.schemas import Port
from .api.server_state import ServerState
from .audit.listener import AuditListener, lease_words, note_settings
from .clock import BackgroundClock, Clock, WallClock
from .conditions.service import ConditionService
from .devices.core.actor import STEPSCOPE
from .devices.core.config import AxisSettings, DeviceConfig
from .devices.core.device import Device
from .devices.core.events import motion_owner
from .devices.core.found_moving import FoundMoving
from .devices.manager import DeviceChange, DeviceManager
from .emulators.build import build_emulator, options_of
from .emulators.core.pace import Pace
from .emulators.wiring import EmulatorWiring, Present
from .errors import BenchError, StoreUnavailable, UsageError
from .lease.lease import Lease
from .lease.watch import LeaseWatch
from .links.emulator import EmulatorPort
from .links.port import FramePort
from .links.registry import (
    Link,
    PortFactory,
    board_factory,
    can_factory,
    serial_factory,
    speaks_tmcl,
    spidev_factory,
    tcp_factory,
    uart_factory,
)
from .links.serial_address import allow_ports
from .macros.service import MacroService
from .positions import ExtendedPositionService
from .preparation import PAGE_FIRST_S, PLAIN, Preparation
from .procedures.at_rest import after_vanishing, anything_moves, stop_moving
from .procedures.procedures import Procedures
from .profiles.service import ProfileService
from .profiles.start_up import StartUpRequest, start_up
from .profiles.undo import UndoService
from .recording.service import RecordingService
from .registers.catalog import find_model
from .registers.wires import BOARD
from .settings import Settings
from .store.audit import FLUSH_S, AuditLog
from .store.connections import ConnectionStore
from .store.database import Database
from .store.layouts import LayoutStore
from .store.macros import MacroStore
from .store.motors import OwnMotors
from .store.positions import PositionStore
from .store.profiles import ProfileStore
from .store.recordings.library import Library
from .store.saver import Saver
from .store.tokens import NamedToken, TokenStore
from .studies.service import StudyService
from .studies.twins.choice import executor_of
from .telemetry.hub import TelemetryHub
from .twin.service import Twin

log = logging.getLogger("stepscope")

EEPROM_NAME = re.compile(r"[a-z0-9][a-z0-9-]{0,63}")
COMMAND_LINE = "on the command line"
SAVE_EVERY_S = 2.0
"""Extended positions change all the time; they are saved no more often than that [s]."""
DATABASE_AFTER_S = 0.6
"""How long a start leaves the core to the page before the audit log is opened, unless somebody asks for it [s]."""
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
    allow_ports(settings.allowed_ports)
    background = BackgroundClock(clock)
    hub = TelemetryHub(background, settings.history_minutes)
    store = ConnectionStore(settings.data_dir)
    pace = Pace(clock.now) if isinstance(clock, WallClock) else None
    kinds: dict[str, PortFactory] = {
        "emulator": partial(emulator_port, data_dir=settings.data_dir, pace=pace),
        "tcp": tcp_factory,
        "serial": serial_factory,
        "can": can_factory,
        "spidev": spidev_factory,
        BOARD: board_factory,
        "uart": uart_factory,
    }
    opened = asyncio.Event()

    wiring = EmulatorWiring()

    def changed() -> None:
        ports = [(device.id, device.session.port) for device in manager.devices]
        wiring.sync([Present(key, port.wire, port) for key, port in ports if isinstance(port, EmulatorPort)])
        hub.sync(manager.devices)
        extended_positions.sync(manager.devices)
        found_moving.sync(manager.devices)
        conditions.sync(manager.devices)
        procedures.sync(manager.devices)
        twin.sync(manager.devices)
        if opened.is_set():  # what comes from the disk need not go back there, and the demo is nobody's doing
            saver.request()
            audit_listener.sync(manager.devices)

    found_moving = FoundMoving(background)

    async def set_up(device: Device) -> None:
        if device.family.kind == "module":
            return  # it keeps its parameters itself
        try:
            await start_up(profiles, device, StartUpRequest())
        except BenchError as error:
            log.warning("%s is not started up: %s", device.name, error)

    # Whoever advances a clock of his own does so by minutes at once: plain Python would take as long for that.
    preparation = Preparation(plain=PLAIN if pace else (), after_s=PAGE_FIRST_S if pace else 0.0)

    async def prepare(model: str, link: Link) -> None:
        if is_emulated(link):
            await preparation.ready(find_model(model).family)

    manager = DeviceManager(kinds, clock, on_change=changed, start_up=set_up, background=background, prepare=prepare)
    to_come: list[DeviceConfig] = []
    """Saved connections that are not open yet: they stay saved, whatever happens until then."""
    saver = Saver(store, lambda: [*manager.configs(), *to_come], clock)
    positions = PositionStore(settings.data_dir)
    extended_positions = ExtendedPositionService(clock, changed=lambda: position_saver.request())
    position_saver = Saver(positions, extended_positions.saved, clock, SAVE_EVERY_S)
    recording_service = RecordingService(
        Library(settings.data_dir),
        hub,
        clock,
        reserve_bytes=round(settings.disk_reserve_mb * 1e6),
        ports=emulator_port,
    )
    database = Database(settings.data_dir)
    audit = AuditLog(database, clock, first_after_s=DATABASE_AFTER_S if pace else FLUSH_S)
    audit_listener = AuditListener(audit)
    lease = Lease(clock, settings.on_vanish, settings.vanish_after_s)
    lease.listen(partial(lease_words, audit))
    twin = Twin(clock, hub)
    vitals = Vitals(clock, settings.data_dir)
    sessions = Sessions(clock)

    def tokens_changed(came: Sequence[NamedToken], went: Sequence[NamedToken], ours: bool) -> None:
        for token in went:
            sessions.end_of_token(token.hash)
        gone = {token.hash for token in went}
        vitals.sockets.end(lambda who: who.hash in gone)
        if not ours:  # a call's own entry tells of it
            for action, tokens in (("revoke token", went), ("add token", came)):
                for token in tokens:
                    audit.note(action, token.name, detail=f"role: {token.role}; {COMMAND_LINE}", by=STEPSCOPE)

    procedures = Procedures(clock)
    conditions = ConditionService(background, lambda device, axis: procedures.search_state(device, axis).state)

    def under_way(device: Device) -> str:
        # A macro that brings a profile in is not in its own way.
        running = [one for one in procedures.running(device) if one is not motion_owner.get()]
        return f"a {running[0].kind} runs" if running else ""

    async def configure(device: Device, axes: Sequence[AxisSettings]) -> None:
        before = [axis.settings for axis in device.axes]
        await manager.edit(device.id, DeviceChange(axes=tuple(axes)))
        note_settings(audit, device, before, axes)

    profiles = ProfileService(settings.data_dir, under_way, configure)
    profile_store = ProfileStore(database)
    studies = StudyService(
        settings.data_dir,
        clock,
        manager.get,
        procedures,
        profiles,
        recording_service,
        profile_store,
        executor_of(clock, settings.dask),
        hub,
    )
    bench = ServerState(
        settings,
        clock,
        background,
        manager,
        hub,
        procedures,
        extended_positions,
        recording_service,
        database,
        audit,
        lease,
        twin,
        profiles,
        UndoService(audit, profiles),
        profile_store,
        conditions,
        list_serial_ports,
        saver,
        position_saver,
        Pages(lease, clock, lambda: anything_moves(manager.devices, procedures)),
        vitals,
        preparation.progress,
        preparation.compiled,
        Tokens(TokenStore(settings.data_dir), tokens_changed),
        sessions,
        MapShelf(settings.data_dir, manager),
        OwnMotors(settings.data_dir),
        LayoutStore(settings.data_dir),
        wiring,
        studies,
        MacroStore(settings.data_dir),
        MacroService(clock, procedures, profiles, profile_store, recording_service, audit),
    )
    lease_watch = LeaseWatch(
        lease, bench.calls, clock, lambda how: after_vanishing(how, manager.devices, bench.procedures)
    )

    async def open_saved(configs: Sequence[DeviceConfig], with_demo: bool) -> None:
        to_come.extend(configs)

        for config in configs:
            try:
                # Not waited for: hardware that is off must not keep the page from coming up.
                await manager.add(config, wait=False)
            except Exception as error:  # neither must a link of another version, or a file edited by hand
                store.keep_back(config)
                left_out = f"{store.path}: {config.name!r} is left out, and stays in the file: {error}"
                log.warning("%s", left_out)
                vitals.notes.append(left_out)
            to_come.remove(config)
        if with_demo:
            await prepare(demo.MODEL, demo.LINK)
            await demo.add(manager)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        try:
            await bench.maps.scan()  # before the connections, some of which are made of them
        except StoreUnavailable as error:
            log.warning("%s", error)
            vitals.notes.append(str(error))
        saved = store.load()
        kept = positions.load()
        for warning in (*saved.warnings, *kept.warnings):
            log.warning("%s", warning)
            vitals.notes.append(warning)
        extended_positions.restore(kept.positions)
        if not pace:  # else it is opened with the first entry of the audit log, or whoever asks for something earlier
            await asyncio.to_thread(database.open)
        await bench.tokens.start()
        profiles.tell_unfinished()
        await asyncio.to_thread(studies.load)
        preparing = asyncio.create_task(preparation.start())
        with_demo = settings.demo or (settings.demo is None and not saved.configs)
        opening = asyncio.create_task(open_saved(saved.configs, with_demo))
        compiling = asyncio.create_task(preparation.compiles())
        # What is on disk is worth waiting for; while something is compiled the server answers.
        await asyncio.wait({opening, compiling}, return_when=asyncio.FIRST_COMPLETED)
        opened.set()
        audit_listener.sync(manager.devices)
        audit.note("start", "stepscope", detail=f"version {__version__}")
        lease_watch.start()
        recording_service.read_ahead()
        vitals.start()
        try:
            yield
        finally:
            opened.clear()
            beginning = (opening, compiling, preparing)
            for task in beginning:
                task.cancel()
            await asyncio.gather(*beginning, return_exceptions=True)
            audit.note("end", "stepscope")
            await lease_watch.close()
            await vitals.close()
            await bench.tokens.close()
            await bench.pages.close()
            await bench.programs.close()
            await bench.probing.abort()
            await profiles.close()
            await stop_motors(bench)
            await studies.close()
            await found_moving.close()
            await conditions.close()
            await bench.twin.off()
            await recording_service.close()  # behind the stops, which belong to what is recorded
            await extended_positions.close()
            if extended_positions.saved():
                position_saver.request()
            await position_saver.close()
            await hub.close()
            await manager.close()
            await preparation.close()  # until then plain Python serves: nobody who stops a motor waits for a compiler
            bench.maps.close()
            await saver.close()
            await audit.close()
            await asyncio.to_thread(database.close)

    return make_app(bench, lifespan, background.urgent)


def emulator_port(
    model: str, link: Link, clock: Clock, data_dir: Path | None = None, pace: Pace | None = None
) -> FramePort:
    """`{"kind": "emulator", ...}`: a chip of its own behind a port of its own.

    `pace` bounds what it works where others wait for it; None where a caller advances `clock` and waits.

    A module may have `"eeprom"`, the name of a file in `data_dir` that keeps its memory; without either the memory
    ends with the port. Raises UsageError.
    """
    options = {name: value for name, value in link.items() if name != "kind"}
    eeprom = options.pop("eeprom", None) if speaks_tmcl(model) else None
    if eeprom is not None and not (isinstance(eeprom, str) and EEPROM_NAME.fullmatch(eeprom)):
        raise UsageError(f"eeprom is a name of small letters, digits and dashes, not {eeprom!r}")
    path = data_dir / "emulators" / f"{eeprom}.json" if eeprom and data_dir else None
    try:
        # Building checks too: a motor may be none that can be worked out, though each of its numbers is one.
        emulator = build_emulator(model, clock, options_of(model).model_validate(options), path)
    except ValidationError as error:
        raise UsageError(f"the emulator's options do not fit: {findings(error)}") from error
    emulator.pace = pace
    return EmulatorPort(emulator, hurries=pace is not None)


def is_emulated(link: Link) -> bool:
    """Whether the device behind the link is an emulator in this process."""
    return link.get("kind") == "emulator"


def bench_of(app: FastAPI) -> ServerState:
    """The bench that `create_app` put together."""
    bench = app.state.bench
    assert isinstance(bench, ServerState)
    return bench


async def stop_motors(bench: ServerState) -> None:
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
        await stop_moving(device)
    except BenchError as error:
        log.warning("the motors of %s were not stopped: %s", device.name, error)
