"""Moves of axes of any devices that start together, and how far apart they really started.

Everything is read and judged first, soft limits too, and nothing that moves a motor goes out before all are ready.
Chips whose START pins are wired then start by one edge; to the others the start goes out as close together as their
links allow. Nothing is sent twice. Where one of them does not start, all are stopped.

The skew is told of what was seen: an emulated chip has its own exact time of the datagram that starts it; of others
only is known that they started between the moment in which it could go out and its answer. What a ramp generator's own
tick adds (of a TMC428 up to 2^ramp_div * 32 clocks, of the others less than 256) is not in it.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from ..clock import Clock
from ..devices.core.capabilities import StartWire
from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, MotionCommanded
from ..devices.core.results import AxisMove, MoveStarted
from ..devices.core.start_gate import start_gate
from ..errors import BenchError, UsageError, WrongState

AXES_MAX = 24
READY_WITHIN_S = 2.0
"""How long all may take to be ready, or to have answered [s]: the lines are taken meanwhile, though not for stops."""
How = Literal["START wire", "command"]


@dataclass(frozen=True, slots=True)
class TogetherMove:
    """The part of one axis."""

    device: Device
    move: AxisMove


@dataclass(frozen=True, slots=True)
class StartNet:
    """Devices, by id, whose START pins are wired together. `uncertainty_s` is how far apart they see one edge [s]."""

    devices: Collection[str]
    uncertainty_s: float


@dataclass(frozen=True, slots=True)
class AxisStart:
    """How one axis started. Names as in the REST contract."""

    device: str
    axis: int
    how: How
    from_position: int
    target_position: int
    skew_s: float
    """After the first one."""
    uncertainty_s: float
    """How much more or less that may be."""
    predicted_duration_s: float | None
    warnings: list[str]


@dataclass(frozen=True, slots=True)
class TogetherStart:
    """How all of them started. `spread_s` is between the first and the last, `at_s` the first on the server's clock."""

    axes: tuple[AxisStart, ...]
    spread_s: float
    uncertainty_s: float
    at_s: float


class NotReady(WrongState):
    """Not this one's fault: another one was not ready, or a stop came."""


@dataclass(frozen=True, slots=True)
class Moment:
    """When something happened, on the server's clock [s], and how much more or less it may be."""

    at_s: float
    uncertainty_s: float


def moment_of(device: Device, at_s: float, earliest_s: float, clock: Clock) -> Moment:
    """Device time `at_s` [s], by which something was answered that went out after `earliest_s` of the server's clock.

    Of an emulated device the time is exact, and runs with the server's.
    """
    if device.session.sampling_port is None:  # its time is the server's, and ends with the answer
        return Moment((earliest_s + at_s) / 2, (at_s - earliest_s) / 2)
    before_s = clock.now()
    device_s = device.device_time_s()
    after_read_s = clock.now()
    return Moment((before_s + after_read_s) / 2 - (device_s - at_s), (after_read_s - before_s) / 2)


@dataclass
class _Party:
    """A device that takes part: the gate that its driver waits at, and when that opened [s]."""

    device: Device
    gate: _Gate
    opened_s: float | None = None

    async def ready(self) -> None:
        if self.opened_s is None:
            await self.gate.wait()
            self.opened_s = self.gate.now()

    def moment(self, after_s: float | None, at_s: float, clock: Clock) -> Moment:
        """Device time `at_s` [s], by which something was answered that went out after `after_s`, None: by the gate."""
        earliest_s = after_s if after_s is not None else self.opened_s if self.opened_s is not None else at_s
        return moment_of(self.device, at_s, earliest_s, clock)


@dataclass(frozen=True, slots=True)
class _Seen:
    """A start as it was seen; `net` where it was by a wire."""

    device: Device
    move: MoveStarted
    moment: Moment
    net: _Net | None


class _Gate:
    """Opens when all have come, or fails for all at once."""

    def __init__(self, parties: int, now: Callable[[], float]) -> None:
        self.now = now
        self._missing = parties
        self._open: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    @property
    def opened(self) -> bool:
        return self._open.done() and self._open.exception() is None

    async def wait(self) -> None:
        self._missing -= 1
        if self._missing == 0 and not self._open.done():
            self._open.set_result(None)
        await asyncio.shield(self._open)

    def require_hope(self) -> None:
        """Raises why it will not open, where that is so."""
        if self._open.done():
            self._open.result()

    def fail(self, why: str) -> None:
        """They start no more, if they have not yet."""
        if not self._open.done():
            self._open.set_exception(NotReady(why, "nothing has started"))
            self._open.exception()  # seen: there may be nobody who waits


async def start_together(
    moves: Sequence[TogetherMove], nets: Sequence[StartNet], clock: Clock, *, use_wires: bool = True
) -> TogetherStart:
    """Start all of `moves`; returns when they have started.

    Raises UsageError for what is no set of moves, and whatever keeps one of them from starting: then nothing moves, or
    what moved was stopped, and the error's note says so.
    """
    by_device = _by_device(moves)
    wired = _wired(by_device, nets) if use_wires else []
    by_wire = {device for net in wired for device in net.devices}
    _require_lines([device for device in by_device if device not in by_wire])
    start = _Start(by_device, wired, clock)
    with start.listening():
        return await start.run()


def _by_device(moves: Sequence[TogetherMove]) -> dict[Device, list[AxisMove]]:
    if not 1 <= len(moves) <= AXES_MAX:
        raise UsageError(f"{len(moves)} axes: 1 to {AXES_MAX} can start together")
    by_device: dict[Device, list[AxisMove]] = {}
    for one in moves:
        one.device.session.require_connected()
        index = one.device.axis(one.move.axis).index
        if any(move.axis == index for move in by_device.get(one.device, [])):
            raise UsageError(f"axis {index} of {one.device.name} is named twice")
        if one.device.session.time_scale != 1:
            raise WrongState(
                f"the time of {one.device.name} does not run with ours, so nothing can start together with it",
                "set its time scale to 1",
            )
        by_device.setdefault(one.device, []).append(one.move)
    return by_device


def _require_lines(devices: Sequence[Device]) -> None:
    """Raises UsageError for two devices on one line: the first would keep it while it waits for the second."""
    seen: dict[int, Device] = {}
    for device in devices:
        other = seen.setdefault(id(device.session.queue.arbiter), device)
        if other is not device:
            raise UsageError(
                f"{other.name} and {device.name} share one line, so one starts after the other: start each alone"
            )


@dataclass(frozen=True, slots=True)
class _Net:
    devices: tuple[Device, ...]
    """The first leads."""
    uncertainty_s: float


def _wired(by_device: dict[Device, list[AxisMove]], nets: Sequence[StartNet]) -> list[_Net]:
    """Those that start by a wire: two or more of one net."""
    found = []
    for net in nets:
        devices = tuple(
            device for device in by_device if device.id in net.devices and device.part(StartWire) is not None
        )
        if len(devices) > 1:
            found.append(_Net(devices, net.uncertainty_s))
    return found


class _Start:
    """One start: who takes part, and what has come of it."""

    def __init__(self, by_device: dict[Device, list[AxisMove]], nets: Sequence[_Net], clock: Clock) -> None:
        self._moves = by_device
        self._nets = nets
        self._clock = clock
        self._by_wire = {device for net in nets for device in net.devices}
        self._alone = [device for device in by_device if device not in self._by_wire]
        self._gate = _Gate(len(self._alone) + len(nets), clock.now)
        self._parties = {device: _Party(device, self._gate) for device in by_device}
        self._armed: list[Device] = []
        self._stopped = ""
        """Which stop came before it started."""
        self._prepared: dict[Device, list[MoveStarted]] = {}
        self._given_s: dict[Device, float] = {}
        """Device time at which a leader had its start [s]."""

    @contextlib.contextmanager
    def listening(self) -> Iterator[None]:
        """Until it has started, a stop of one of them ends it for all."""
        ends = [device.listen(self._listener(device)) for device in self._moves]
        try:
            yield
        finally:
            for end in ends:
                end()

    def _listener(self, device: Device) -> Callable[[DeviceEvent], None]:
        axes = {move.axis for move in self._moves[device]}

        def hear(event: DeviceEvent) -> None:
            if isinstance(event, MotionCommanded) and event.what == "stop" and event.axis in axes:
                self._stopped = f"a stop of axis {event.axis} of {device.name} overtook the start"
                self._gate.fail(self._stopped)

        return hear

    async def run(self) -> TogetherStart:
        try:
            for net in self._nets:
                await self._arm(net)
            await self._set_off()
        except BaseException as error:
            opened = self._gate.opened
            self._gate.fail(str(error))
            await self._undo()
            if self._stopped and not opened and isinstance(error, BenchError):  # which is what that has led to
                raise NotReady(self._stopped, "nothing has started") from error
            raise
        started = await self._check_wired()
        if started is not None:
            await self._undo()
            raise started
        await self._disarm(started=True)
        return self._told()

    async def _arm(self, net: _Net) -> None:
        """Have the targets of a net wait for its start. Who leads is armed first: its START is at rest then."""
        for number, device in enumerate(net.devices):
            self._gate.require_hope()
            axis = self._moves[device][0].axis
            self._armed.append(device)
            await device.need(StartWire).arm_start(axis, leads=number == 0)
        for device in net.devices:
            self._gate.require_hope()
            self._prepared[device] = await device.motion.move_together(self._moves[device])

    async def _set_off(self) -> None:
        """Have all go when all are ready. Raises the error of whoever kept them from it."""
        tasks = [asyncio.create_task(self._move(device), name=f"start {device.id}") for device in self._alone]
        tasks += [asyncio.create_task(self._give(net), name=f"start by {net.devices[0].id}") for net in self._nets]
        pending = await self._wait(tasks, asyncio.FIRST_EXCEPTION)
        failed = any(task.exception() for task in tasks if task.done())
        if not pending and not failed:
            return
        self._gate.fail("another one was not ready")  # who waits there ends; a frame on its way is not cut
        for task in await self._wait(pending, asyncio.ALL_COMPLETED) if pending else ():
            task.cancel()
        if not failed:
            raise WrongState(f"not all were ready within {READY_WITHIN_S:g} s", "see which device is slow to answer")
        errors = [error for task in tasks if task.done() and not task.cancelled() and (error := task.exception())]
        causes = [error for error in errors if not isinstance(error, NotReady)]
        raise (causes or errors)[0]

    async def _wait(self, tasks: Collection[asyncio.Task[None]], until: str) -> list[asyncio.Task[None]]:
        """Wait for them, for `READY_WITHIN_S` of the server's clock at the most; those that are not over."""
        late = asyncio.create_task(self._clock.sleep(READY_WITHIN_S))
        over: set[asyncio.Task[None]] = set()
        try:
            while not late.done() and not over.issuperset(tasks):
                done, _ = await asyncio.wait({late, *tasks} - over, return_when=asyncio.FIRST_COMPLETED)
                over |= done
                if until == asyncio.FIRST_EXCEPTION and any(task.exception() for task in over - {late}):
                    break
        finally:
            late.cancel()
        return [task for task in tasks if not task.done()]

    async def _move(self, device: Device) -> None:
        start_gate.set(self._parties[device])
        self._prepared[device] = await device.motion.move_together(self._moves[device])

    async def _give(self, net: _Net) -> None:
        leader = net.devices[0]
        await self._parties[leader].ready()
        await leader.need(StartWire).give_start(self._moves[leader][0].axis)
        self._given_s[leader] = leader.session.port.last_exchange_s

    async def _check_wired(self) -> BenchError | None:
        for net in self._nets:
            for device in net.devices:
                moved = self._prepared[device][0]
                if moved.from_position == moved.target_position:
                    continue
                try:
                    if not await device.need(StartWire).has_started(moved.axis):
                        return WrongState(
                            f"{device.name} did not start: its START pin saw nothing of that of {net.devices[0].name}",
                            "see to the wire; all that had started was stopped",
                        )
                except BenchError as error:
                    return error
        return None

    # --- the end ----------------------------------------------------------------------------------

    async def _undo(self) -> None:
        """Stop what has started, and take targets back that wait."""
        if self._gate.opened:
            stops = [device.stop_axes([move.axis for move in moves], "ramp") for device, moves in self._moves.items()]
            await asyncio.gather(*stops, return_exceptions=True)
        await self._disarm(started=False)

    async def _disarm(self, *, started: bool) -> None:
        armed, self._armed = self._armed, []
        # Who listens first: what becomes of the leader's pin must not look like a start.
        for device in reversed(armed):
            with contextlib.suppress(BenchError):
                await device.need(StartWire).disarm_start(self._moves[device][0].axis, started=started)

    def _told(self) -> TogetherStart:
        seen: list[_Seen] = []
        for net in self._nets:
            leader = net.devices[0]
            edge = self._parties[leader].moment(None, self._given_s[leader], self._clock)
            seen += [_Seen(device, one, edge, net) for device in net.devices for one in self._prepared[device]]
        for device in self._alone:
            after_s: float | None = None
            for one in self._prepared[device]:
                moment = self._parties[device].moment(after_s, one.started_at_s, self._clock)
                seen.append(_Seen(device, one, moment, None))
                after_s = one.started_at_s
        first = min(seen, key=lambda each: each.moment.at_s)
        order = {device: number for number, device in enumerate(self._moves)}
        seen.sort(key=lambda each: (order[each.device], each.move.axis))
        axes = tuple(_axis_start(each, first) for each in seen)
        spread_s, uncertainty_s = max(axis.skew_s for axis in axes), max(axis.uncertainty_s for axis in axes)
        return TogetherStart(axes, spread_s, uncertainty_s, first.moment.at_s)


def _axis_start(seen: _Seen, first: _Seen) -> AxisStart:
    uncertainty_s = seen.moment.uncertainty_s + first.moment.uncertainty_s
    if seen is first:
        uncertainty_s = 0.0
    elif seen.net is not None:
        edge_s = seen.net.uncertainty_s
        uncertainty_s = edge_s if seen.net is first.net else uncertainty_s + edge_s
    one = seen.move
    return AxisStart(
        device=seen.device.id,
        axis=one.axis,
        how="command" if seen.net is None else "START wire",
        from_position=one.from_position,
        target_position=one.target_position,
        skew_s=seen.moment.at_s - first.moment.at_s,
        uncertainty_s=uncertainty_s,
        predicted_duration_s=one.predicted_duration_s,
        warnings=[text for text in one.warnings if seen.net is None or "waits for a start signal" not in text],
    )
