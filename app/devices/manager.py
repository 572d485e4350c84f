"""Owns all connections: makes them, watches them, brings them back, and stops everything at once.

What this session set in motion it stops before it lets go of a device (disconnect, remove, shut
down). Axes that it never moved it leaves alone.
"""

from __future__ import annotations

import asyncio
import contextlib
import gc
import logging
import time
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from ..clock import Clock
from ..errors import BenchError, DownloadMode, LinkTimeout, UnknownThing, UsageError
from ..links.registry import Link, PortFactory, open_port
from ..registers.catalog import MODELS
from .core.config import AxisSettings, DeviceConfig, unique_slug
from .core.cover import COVER, CoverPort, cover_port, driver_place
from .core.device import Device
from .core.results import StopMode, StopOutcome
from .core.stopping import Stopping
from .core.watch import ANSWER_WITHIN_S, Watch
from .families import limit, make_device, require_clock
from .limits.apply import learn

log = logging.getLogger("stepscope.devices")

LET_GO_S = 1.0
"""How long letting go of a device may take to stop its motors [s]."""
COLLECT_AFTER_S = 1.0
"""The parts of a device know each other, so only the garbage collector frees them, with history and emulator, and by
itself so late that memory has grown meanwhile. It is called so long after one was removed [s], once for many."""


@dataclass(frozen=True, slots=True)
class DeviceChange:
    """What to edit; None leaves as it is. A new name makes a new id, a new link or model a new connection."""

    name: str | None = None
    model: str | None = None
    link: Link | None = None
    clock_hz: float | None = None
    axes: tuple[AxisSettings, ...] | None = None


@dataclass(frozen=True, slots=True)
class LinkTrial:
    """What a trial of a link found, without keeping anything."""

    ok: bool
    detail: str
    round_trip_ms: float | None
    problem: BenchError | None


class DeviceManager:
    """`kinds` are the link kinds that the composition root offers; `on_change` hears of any change worth storing;
    `start_up` sets up an emulator that was just powered, where its connection says so, and raises nothing; `background`
    is the clock of polls that may wait while motors are stopped; `prepare` is waited for before a link is made: what
    an emulator needs is compiled at a first start."""

    def __init__(
        self,
        kinds: Mapping[str, PortFactory],
        clock: Clock,
        on_change: Callable[[], None] | None = None,
        start_up: Callable[[Device], Awaitable[None]] | None = None,
        background: Clock | None = None,
        prepare: Callable[[str, Link], Awaitable[None]] | None = None,
    ) -> None:
        self._kinds = {**kinds, COVER: self._cover_port}
        self._clock = clock
        self._background = background or clock
        self._on_change = on_change or (lambda: None)
        self._start_up = start_up
        self._prepare = prepare or _nothing
        self._devices: dict[str, Device] = {}
        self._watches: dict[Device, Watch] = {}
        self._stopping = Stopping()
        self._collecting: asyncio.TimerHandle | None = None

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of links on offer."""
        return tuple(self._kinds)

    @property
    def devices(self) -> tuple[Device, ...]:
        """All devices, in the order they were added."""
        return tuple(self._devices.values())

    def get(self, device_id: str) -> Device:
        """Raises UnknownThing."""
        device = self._devices.get(device_id)
        if device is None:
            raise UnknownThing("device", device_id, list(self._devices))
        return device

    def drivers_of(self, device_id: str) -> tuple[tuple[int, Device], ...]:
        """Devices whose links go through that one, with the axis whose driver each is, by axis."""
        found = ((place, device) for device in self.devices if (place := driver_place(device.link)) is not None)
        behind = [(place[1], device) for place, device in found if place[0] == device_id]
        return tuple(sorted(behind, key=lambda each: each[0]))

    def configs(self) -> list[DeviceConfig]:
        """What there is to keep: every connection but the demo's."""
        return [device.config for device in self.devices if not device.config.demo]

    async def add(self, config: DeviceConfig, *, connect: bool = True, wait: bool = True) -> Device:
        """Add a connection. One that does not answer is added all the same; its state tells why.

        With `wait` the first attempt is over on return, and always that of an emulator to be set up. Raises UsageError
        for a link that cannot be.
        """
        await self._prepare(config.model, config.link)
        self._require_free(config.link)
        device = self._make(config, unique_slug(config.name, self._devices))
        self._devices[device.id] = device
        self._on_change()
        if connect:
            await self._start(device, wait=wait or config.start_up)
            await self._powered(device)
        return device

    async def edit(self, device_id: str, change: DeviceChange) -> Device:
        """Change a connection. Only a new link or model disturbs it. An edited demo device becomes an ordinary one.

        Raises UnknownThing, or UsageError for what cannot be; then nothing has changed.
        """
        device = self.get(device_id)
        old = device.config
        model = old.model if change.model is None else change.model
        clock_hz = old.clock_hz if change.clock_hz is None else change.clock_hz
        axes = old.axes if change.axes is None else change.axes
        if model != old.model:  # what was never chosen is the new model's own
            clock_hz = 0.0 if change.clock_hz is None and clock_hz == device.family.clock_hz_default else clock_hz
            axes = axes[: MODELS[model].axes]
        config = replace(
            old,
            model=model,
            name=old.name if change.name is None else change.name,
            link=old.link if change.link is None else change.link,
            clock_hz=clock_hz,
            axes=axes,
            demo=False,
        )
        others = [other for other in self._devices if other != device_id]
        new_id = device_id if config.name == old.name else unique_slug(config.name, others)
        if (config.link, config.model) == (old.link, old.model):
            require_clock(device, config)
            device.session.reconfigure(new_id, config)
            self._follow_name(device_id, new_id)
            limit(device)
            await learn(device)
            self._put(device_id, device)
            self._on_change()
            return device
        await self._prepare(config.model, config.link)
        self._require_free(config.link, device)
        successor = self._make(config, new_id)
        connected = device.state != "disconnected"
        self._follow_name(device_id, new_id)
        self._put(device_id, successor)
        self._on_change()
        await self._let_go(device)
        self._collect_soon()
        if connected:
            await self._start(successor, wait=True)
            await self._powered(successor)
        return successor

    def describe_link(self, device_id: str, option: str, value: Sequence[object]) -> None:
        """Keep in a link what has been changed behind it: it is no other one. An empty `value` leaves the option out.

        An edited demo device becomes an ordinary one. Raises UnknownThing.
        """
        device = self.get(device_id)
        link = {name: said for name, said in device.link.items() if name != option}
        link |= {option: value} if value else {}
        device.session.reconfigure(device.id, replace(device.config, link=link, demo=False))
        self._on_change()

    def renew(self, model: str) -> None:
        """Make disconnected devices of `model` anew: its table is another one now. One whose link it has no more stays
        as it was."""
        for device in self.devices:
            if device.model != model or device.state != "disconnected":
                continue
            config = replace(device.config, axes=device.config.axes[: MODELS[model].axes])
            try:
                successor = self._make(config, device.id)
            except BenchError as error:
                log.warning("%s stays as it was: %s", device.name, error)
                continue
            self._put(device.id, successor)
            self._on_change()
            self._collect_soon()

    async def remove(self, device_id: str) -> None:
        """Forget a connection. Raises UnknownThing."""
        device = self.get(device_id)
        del self._devices[device_id]
        self._on_change()
        await self._let_go(device)
        self._collect_soon()

    async def connect(self, device_id: str) -> Device:
        """Connect, or try at once again where that failed; the state tells what came of it. Raises UnknownThing."""
        device = self.get(device_id)
        if device.state != "connected":
            await self._end_watch(device)
            await self._start(device, wait=True)
        return device

    async def disconnect(self, device_id: str) -> Device:
        """Disconnect and stay so. Raises UnknownThing."""
        device = self.get(device_id)
        await self._let_go(device)
        return device

    async def test(self, model: str, link: Link) -> LinkTrial:
        """Try a link without keeping it. Raises UsageError for a link that cannot be."""
        await self._prepare(model, link)
        device = self._make(DeviceConfig(name="trial", model=model, link=link), "trial")
        try:
            async with asyncio.timeout(ANSWER_WITHIN_S):
                detail = await device.identity.probe()
                once = time.perf_counter()  # the first one opened the link: only the second is a round trip
                await device.identity.probe()
        except TimeoutError:
            late = LinkTimeout(device.session.port.name, ANSWER_WITHIN_S, "who it is")
            return LinkTrial(False, str(late), None, late)
        except BenchError as error:
            return LinkTrial(False, str(error), None, error)
        else:
            return LinkTrial(True, detail, (time.perf_counter() - once) * 1e3, None)
        finally:
            await device.session.port.aclose()

    async def stop_all(self, mode: StopMode = "ramp") -> list[StopOutcome]:
        """Every axis of every device, ahead of all queues, all devices at once. Never raises.

        Answers in `STOP_WITHIN_S`, whatever a device does. One that is disconnected cannot be stopped, and its
        outcome says so.
        """
        stops = [self._stopping.stop(each, [axis.index for axis in each.axes], mode) for each in self.devices]
        return [outcome for outcomes in await asyncio.gather(*stops) for outcome in outcomes]

    async def stop_axis(self, device: Device, axis: int, mode: StopMode = "ramp") -> StopOutcome:
        """One axis, as soon. Raises what went wrong."""
        device.session.require_connected()
        outcome = (await self._stopping.stop(device, [device.axis(axis).index], mode))[0]
        if outcome.problem is not None:
            raise outcome.problem
        return outcome

    async def close(self) -> None:
        """Let go of everything. For the end of the program."""
        await asyncio.gather(*(self._let_go(device) for device in self.devices))
        await self._stopping.close()
        if self._collecting is not None:
            self._collecting.cancel()

    # --- inside ---------------------------------------------------------------------------------

    def _make(self, config: DeviceConfig, device_id: str) -> Device:
        port = open_port(self._kinds, config.model, config.link, self._clock)
        device = make_device(device_id, config, port, self._clock)
        device.session.background = self._background
        device.drivers_behind = lambda: self.drivers_of(device.id)
        device.session.driven = lambda: {axis: driver.name for axis, driver in self.drivers_of(device.id)}
        return device

    def _cover_port(self, model: str, link: Link, clock: Clock) -> CoverPort:
        return cover_port(self.get, model, link, clock)

    def _require_free(self, link: Link, but: Device | None = None) -> None:
        """Raises UsageError where the link goes to an axis that has a driver."""
        wanted = driver_place(link)
        for other in self.devices:
            if wanted is not None and other is not but and driver_place(other.link) == wanted:
                raise UsageError(f"axis {wanted[1]} of {wanted[0]} has a driver already: {other.name}")

    def _follow_name(self, old_id: str, new_id: str) -> None:
        """The links of drivers name their controller anew."""
        for axis, driver in self.drivers_of(old_id):
            port = driver.session.port
            if old_id != new_id and isinstance(port, CoverPort):
                link = {"kind": COVER, "device": new_id, "axis": axis}
                driver.session.reconfigure(driver.id, replace(driver.config, link=link))
                port.device_id = new_id

    def _put(self, old_id: str, device: Device) -> None:
        # Rebuilt, not replaced: a renamed device keeps its place in the list.
        self._devices = {
            (device.id if key == old_id else key): (device if key == old_id else other)
            for key, other in self._devices.items()
        }

    def _collect_soon(self) -> None:
        if self._collecting is None:
            self._collecting = asyncio.get_running_loop().call_later(COLLECT_AFTER_S, self._collect)

    def _collect(self) -> None:
        self._collecting = None
        gc.collect()

    async def _start(self, device: Device, *, wait: bool) -> None:
        watch = self._watches[device] = Watch(device, self._background)
        await watch.start(wait=wait)

    async def _powered(self, device: Device) -> None:
        """Its emulator is new: as after power-on."""
        if self._start_up is not None and device.config.start_up and device.state == "connected":
            await self._start_up(device)

    async def _end_watch(self, device: Device) -> None:
        watch = self._watches.pop(device, None)
        if watch is not None:
            await watch.stop()

    async def _let_go(self, device: Device) -> None:
        await self._end_watch(device)
        moved = [axis.index for axis in device.axes if device.session.motion_commands[axis.index]]
        if moved and (device.state == "connected" or isinstance(device.session.held_back, DownloadMode)):
            # What comes of it nobody is there to hear; the link is closed next.
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(LET_GO_S):
                    await device.stop_axes(moved)
        device.session.set_state("disconnected")
        await device.identity.let_go()
        await device.session.port.aclose()


async def _nothing(model: str, link: Link) -> None:
    del model, link
