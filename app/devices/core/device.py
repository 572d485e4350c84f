"""One connected thing: who it is, whether it answers, and the parts of its driver."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar, cast

from ...errors import BenchError, DownloadMode, OtherModel, UsageError, WrongState
from ...links.registry import Link
from ...registers.catalog import Model
from .capabilities import (
    MISSING,
    AxisMonitor,
    ConfigurationRules,
    Identity,
    Motion,
    PositionCounter,
    RawFrames,
    Registers,
    Telemetry,
)
from .config import DeviceConfig
from .events import DeviceEvent, LimitReached
from .holding_back import OnlyReading
from .results import DeviceState, StopMode, StopOutcome
from .session import Axis, Session
from .signs import Remedy

if TYPE_CHECKING:
    from .limit_guard import LimitGuard

P = TypeVar("P")


@dataclass(frozen=True, slots=True)
class Parts:
    """What a family's driver is composed of.

    others : what only some families have, each a capability of `capabilities` or a part of its family alone
    """

    identity: Identity
    registers: Registers
    raw: RawFrames
    motion: Motion
    monitor: AxisMonitor
    counter: PositionCounter
    telemetry: Telemetry
    configuration: ConfigurationRules
    others: tuple[object, ...] = field(default=())


class Device:
    """A chip or module behind a link: its session, and the parts of its driver."""

    def __init__(self, session: Session, parts: Parts) -> None:
        self.session = session
        self.registers = parts.registers
        self.raw = parts.raw
        self.motion = parts.motion
        self.monitor = parts.monitor
        self.counter = parts.counter
        self.telemetry = parts.telemetry
        self.configuration = parts.configuration
        self.identity = parts.identity
        self._parts: tuple[object, ...] = (
            *parts.others,
            parts.registers,
            parts.raw,
            parts.motion,
            parts.monitor,
            parts.counter,
            parts.telemetry,
            parts.configuration,
            parts.identity,
        )
        self.driver_of: Callable[[Device, str], Device] | None = None
        """Makes the driver of another model for the same port (`families`), to stop what answers there."""
        self.drivers_behind: Callable[[], Sequence[tuple[int, Device]]] = tuple
        """Devices whose links go through this one, each with the axis whose driver it is; for the manager."""
        self.notes: tuple[str, ...] = ()
        """What a user has to know of this device at present: see `found_moving`."""
        self._always_holds = session.queue.holds

    # --- who it is ------------------------------------------------------------------------------

    @property
    def id(self) -> str:
        return self.session.id

    @property
    def config(self) -> DeviceConfig:
        return self.session.config

    @property
    def name(self) -> str:
        return self.session.name

    @property
    def model(self) -> str:
        return self.session.model

    @property
    def family(self) -> Model:
        """The catalog's entry of this model."""
        return self.session.family

    @property
    def link(self) -> Link:
        return self.session.link

    @property
    def clock_hz(self) -> float:
        return self.session.clock_hz

    @property
    def axes(self) -> tuple[Axis, ...]:
        return self.session.axes

    def axis(self, index: int) -> Axis:
        """Raises UnknownThing for an axis that the chip does not have."""
        return self.session.axis(index)

    def device_time_s(self) -> float:
        """Now, device time [s]."""
        return self.session.device_time_s()

    # --- what it can ----------------------------------------------------------------------------

    def part(self, kind: type[P]) -> P | None:
        """The part of that class, or that inherits that capability; None where this device has none."""
        return cast("P | None", next((part for part in self._parts if kind in type(part).__mro__), None))

    def need(self, kind: type[P]) -> P:
        """The part with that capability. Raises WrongState, with what to do instead, where there is none."""
        part = self.part(kind)
        if part is None:
            what, instead = MISSING[kind]
            raise WrongState(f"a {self.family.title} {what}", instead)
        return part

    # --- whether it answers ---------------------------------------------------------------------

    @property
    def state(self) -> DeviceState:
        return self.session.state

    @property
    def problem(self) -> BenchError | None:
        """Why it is not connected; None while it is."""
        return self.session.problem

    def listen(self, listener: Callable[[DeviceEvent], None]) -> Callable[[], None]:
        """Hear of state changes and starts; returns the function that ends it. A listener must not raise."""
        return self.session.listen(listener)

    async def identify(self) -> None:
        """Probe it, and be warned: as long as something else answers than expected, nothing goes out but readings and
        stops. Raises what `Identity.probe` raises."""
        session = self.session
        try:
            await self.identity.probe()
        except DownloadMode:
            raise
        except WrongState as error:
            session.stranger = error
            session.queue.holds = (*self._always_holds, OnlyReading(error, self.identity.only_reads))
            raise
        session.stranger = None
        session.queue.holds = self._always_holds

    def ways_out(self, why: WrongState) -> tuple[Remedy, ...]:
        """What ends that the driver keeps still because of `why`."""
        if isinstance(why, OtherModel):
            return tuple(
                Remedy(f"change the model to {name.upper()}", "PATCH", "", {"model": name}) for name in why.found
            )
        return self.identity.ways_out(why)

    # --- soft limits and stops ------------------------------------------------------------------

    @property
    def limiter(self) -> LimitGuard | None:
        """Keeps the soft limits of the axes; None where there are none."""
        return self.session.limiter

    def limit_warnings(self, axis: int) -> list[str]:
        """What the chip is set to beyond the soft limits of `axis`, and what to write; empty where all is well."""
        index, limiter = self.axis(axis).index, self.limiter
        return [] if limiter is None else limiter.findings(index)

    def stopped_by_limit(self, reached: LimitReached) -> None:
        """For the watch over the range of positions."""
        self.session.tell(reached)

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        """Stop ahead of everything that waits for this link. Failures are in the outcomes, not raised.

        Where another model answers, that one is stopped, with all its axes: nobody knows which of them is meant.
        """
        why = self.session.stranger
        if isinstance(why, OtherModel) and not why.same_stop:
            for axis in axes:
                self.session.stops[axis] += 1
                self.session.commanded(axis, "stop", mode=mode)
            return await self._stop_stranger(why, axes, mode)
        return await self.motion.stop_axes(axes, mode)

    async def stop(self, axis: int, mode: StopMode = "ramp") -> StopOutcome:
        """Stop one axis. Raises what went wrong."""
        self.session.require_connected()
        outcome = (await self.stop_axes([self.axis(axis).index], mode))[0]
        if outcome.problem is not None:
            raise outcome.problem
        return outcome

    async def _stop_stranger(self, why: OtherModel, axes: Sequence[int], mode: StopMode) -> list[StopOutcome]:
        """Stop what answers by the driver of its own model; `why` for each axis where there is none."""
        began = time.perf_counter()
        problem: BenchError | None = why
        if why.found and self.driver_of is not None:
            try:
                driver = self.driver_of(self, why.found[0])
            except UsageError as error:
                problem = error
            else:
                try:
                    stopped = await driver.motion.stop_axes([axis.index for axis in driver.axes], mode)
                finally:
                    await driver.identity.let_go()
                problem = next((outcome.problem for outcome in stopped if outcome.problem is not None), None)
        took_ms = (time.perf_counter() - began) * 1e3
        return [StopOutcome(self.id, axis, problem is None, took_ms, problem) for axis in axes]
