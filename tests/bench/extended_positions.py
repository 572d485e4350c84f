"""Extended positions: what their service costs, and whether a year of rotation stays exact.

The cost is counted, not inferred: every turn that the event loop gives to the service, and every look of a driver that
it hears of, is timed in the thread's own CPU time, in a run on the wall clock in which drivers, links and emulators do
what they always do. What of it the drivers and emulators spend answering the service is told apart.
"""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections.abc import Awaitable, Callable, Coroutine, Generator, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from typing import Any, cast

from app.calc.positions.extended import Counter
from app.clock import VirtualClock, WallClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.devices.tmc5xxx.family import compose
from app.devices.tmc5xxx.moves import SixPointMotion
from app.devices.tmc5xxx.start_up import Start, start_up
from app.devices.tmc428.start_up import AxisStart
from app.devices.tmc428.start_up import start_up as start_up_428
from app.emulators.build import build_emulator
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxOptions
from app.links.emulator import EmulatorPort
from app.main import emulator_port
from app.positions import ExtendedPositionService
from app.positions.axis import WatchedAxis
from app.positions.observer import Observer
from app.registers.catalog import MODELS
from tests.bench.table import Row
from tests.calc.turn_offset import TurnOffset

AXES = 32
CPU_LIMIT = 0.01
YEAR_S = 365 * 86_400
YEAR_LIMIT_S = 60.0
PER_TURN = 51_200
GEAR = (PER_TURN, 3, 7)
"""Three teeth on the motor, seven on the shaft."""


# --- what it costs ------------------------------------------------------------------------------


@dataclass
class Spent:
    """CPU time [s] of the service itself, of drivers and emulators answering it, and how often it was asked."""

    own_s: float = 0.0
    links_s: float = 0.0
    looks: int = 0
    heard: int = 0


class _Timed:
    """A coroutine whose every turn is timed."""

    def __init__(self, work: Coroutine[Any, Any, Any], add: Callable[[float], None]) -> None:
        self._work = work
        self._add = add

    def __await__(self) -> Generator[Any, Any, Any]:
        steps, value = self._work.__await__(), None
        while True:
            began_s = time.thread_time()
            try:
                wanted = steps.send(value)
            except StopIteration as end:
                return end.value
            finally:
                self._add(time.thread_time() - began_s)
            value = yield wanted


@contextlib.contextmanager
def counted() -> Iterator[Spent]:
    """Time the service while this holds."""
    spent, originals = Spent(), (WatchedAxis.serve, Observer._heard)
    timed_devices: set[Device] = set()
    serve, heard = originals

    def own(seconds: float) -> None:
        spent.own_s += seconds

    def link(seconds: float) -> None:
        spent.links_s += seconds
        spent.own_s -= seconds  # it is within a turn of the service

    def timed_link(call: Callable[..., Coroutine[Any, Any, Any]]) -> Callable[..., Awaitable[Any]]:
        async def timed(*arguments: Any) -> Any:
            return await _Timed(call(*arguments), link)

        return timed

    async def timed_serve(self: WatchedAxis) -> float:
        spent.looks += 1
        device = self.device
        if device not in timed_devices:
            timed_devices.add(device)
            parts: tuple[tuple[Any, str], ...] = (
                (device.counter, "poll"),
                (device.motion, "retarget"),
                (device.monitor, "axis_state"),
            )
            for part, name in parts:
                setattr(part, name, timed_link(getattr(part, name)))
        return cast("float", await _Timed(serve(self), own))

    def timed_heard(self: Observer, event: Any) -> None:
        spent.heard += 1
        began_s = time.thread_time()
        heard(self, event)
        took_s = time.thread_time() - began_s
        spent.own_s += took_s
        if self.lock.locked():  # told by a look of our own: it is within the link's share, and that within ours
            spent.links_s -= took_s

    WatchedAxis.serve, Observer._heard = timed_serve, timed_heard  # type: ignore[method-assign]
    try:
        yield spent
    finally:
        WatchedAxis.serve, Observer._heard = originals  # type: ignore[method-assign]


async def _cost(model: str, seconds: float) -> tuple[Spent, float, int]:
    """The service of 32 axes on their way to a far target at top speed; CPU time, wall time [s], wraps on the way."""
    clock = WallClock()
    saves = []
    service = ExtendedPositionService(clock, lambda: saves.append(1))
    manager = DeviceManager({"emulator": emulator_port}, clock, lambda: service.sync(manager.devices))
    chips = -(-AXES // MODELS[model].axes)
    link = {"kind": "emulator", "motor": "rigid"} if model.startswith("tmc5") else {"kind": "emulator"}
    axes: list[tuple[Device, int]] = []
    for number in range(chips):
        device = await manager.add(DeviceConfig(f"chip {number}", model, link))
        of_it = range(min(MODELS[model].axes, AXES - len(axes)))
        if model.startswith("tmc5"):
            await start_up(device, [Start(vmax=7_999_000, amax=7_000_000, stops=False)] * len(of_it))
        else:
            await start_up_428(device, [AxisStart(2047, 500, 0, 6, stops=False)] * len(of_it))
        axes += [(device, axis) for axis in of_it]
    with counted() as counting:
        for device, axis in axes:
            await service.go_to(device, axis, 1 << 50)
        await asyncio.sleep(3)  # up to speed
        before, began_s = replace(counting), time.perf_counter()
        await asyncio.sleep(seconds)
        took_s, after = time.perf_counter() - began_s, replace(counting)
    states = [await service.state(device, axis) for device, axis in axes]
    assert all(state.trusted and state.state == "moving" for state in states), states
    wraps = sum((state.actual or 0) >> (state.counter_bits or 0) for state in states)
    spent = Spent(
        after.own_s - before.own_s,
        after.links_s - before.links_s,
        after.looks - before.looks,
        after.heard - before.heard,
    )
    await manager.stop_all("immediate")
    await service.close()
    await manager.close()
    return spent, took_s, wraps


def measure_cost(model: str, *, quick: bool) -> Row:
    """32 axes of this model."""
    spent, took_s, wraps = asyncio.run(_cost(model, 10.0 if quick else 60.0))
    own, links = spent.own_s / took_s, spent.links_s / took_s
    return Row(
        what=f"service of {AXES} axes of {MODELS[model].title} at top speed",
        measured=f"{100 * (own + links):.2f} % of a core",
        peer=f"{100 * CPU_LIMIT:g} %",
        ratio=(own + links) / CPU_LIMIT,
        required="< 1",
        ok=own + links < CPU_LIMIT,
        notes=(
            f"{100 * own:.2f} % the service, {100 * links:.2f} % drivers, links and emulators answering it",
            f"{spent.looks / took_s:.1f} looks of its own a second, {spent.heard / took_s:.0f} heard of; {wraps} wraps",
        ),
    )


# --- a year -------------------------------------------------------------------------------------


class Slow(SixPointMotion):
    """A part that is told how fast its motor turns: looks as far apart as that allows."""

    def speed_limit_pps(self, axis: int) -> float:
        return 1.01 * PER_TURN


async def _year(seconds: int) -> tuple[float, int, int]:
    """Turn a motor once a second for `seconds`; wall time [s], looks, and wraps of the counter. Raises where wrong."""
    clock = VirtualClock()
    wire = build_emulator("tmc5160", clock, Tmc5xxxOptions(motor="rigid"))
    assert isinstance(wire, EmulatedTmc5xxx)
    config = DeviceConfig("year", "tmc5160", {"kind": "emulator"})
    # A driver looks on ten times a second while its motor moves, which in a year is 300 million times: its own clock
    # stands still here, and nobody looks but the service.
    device = compose("year", config, EmulatorPort(wire), VirtualClock())
    assert isinstance(device.motion, SixPointMotion)
    device.motion = Slow(**{part.name: getattr(device.motion, part.name) for part in fields(device.motion)})
    service = ExtendedPositionService(clock, unix_s=clock.now, period_max_s=float("inf"))
    await device.identity.refresh()
    device.session.set_state("connected")
    await start_up(device, [Start(vmax=PER_TURN, amax=1_000_000, stops=False)])
    await service.set_gear(device, 0, GEAR)
    turn = Fraction(PER_TURN * GEAR[2], GEAR[1])
    note = TurnOffset(turn, Counter(32), 0)
    target = PER_TURN * seconds + 12_345
    began_s = time.perf_counter()
    await service.go_to(device, 0, target)
    looks, before_s, checked_s = 0, -1.0, 0.0
    while (watched := service._axes[device, 0]).going is not None:
        await clock.advance(1000.0 if watched.tracker.position < target - 2 * 1000 * PER_TURN else 10.0)
        if watched.tracker.asked_s == before_s:
            continue
        looks, before_s = looks + 1, watched.tracker.asked_s
        state = watched.state()
        assert state.trusted, state.reason
        assert state.rotary is not None
        assert state.counter is not None
        assert state.rotary.turns * turn + state.rotary.place == state.actual
        assert note.update(state.counter) == state.rotary.place
        if clock.now() - checked_s > seconds / 12:  # every month the same instant, by both
            checked_s = clock.now()
            state = await service.state(device, 0)
            assert state.actual == _field(wire, checked_s), (state.actual, _field(wire, checked_s))
    state = await service.state(device, 0)
    field = _field(wire, clock.now())
    took_s = time.perf_counter() - began_s
    assert state.message == "at its target", state.message
    assert state.actual == target == field, (state.actual, target, field)
    assert state.rotary is not None
    assert (state.rotary.turns, state.rotary.place) == divmod(Fraction(target), turn)
    await service.close()
    return took_s, looks, target >> 32


def _field(wire: EmulatedTmc5xxx, at_s: float) -> int:
    """Every microstep that the emulator's field has made, which never wraps: 256 a full step, exact in a float."""
    return int(wire.state(at_s).axes[0].truth.field_fullsteps * 256)


def measure_year(*, quick: bool) -> Row:
    """A year, or for a look a month of it."""
    seconds = YEAR_S // 12 if quick else YEAR_S
    took_s, looks, wraps = asyncio.run(_year(seconds))
    limit_s = YEAR_LIMIT_S * seconds / YEAR_S
    return Row(
        what=f"a simulated {'month' if quick else 'year'} of rotation, 3:7 gear, exact",
        measured=f"{took_s:.3g} s",
        peer=f"{limit_s:.3g} s",
        ratio=took_s / limit_s,
        required="< 1",
        ok=took_s < limit_s,
        notes=(
            f"one turn of the motor a second; {looks} looks, {wraps} wraps of 32 bits, one move in pieces",
            "driver, service and emulated TMC5160; exact against the emulator's unwrapped count of its field",
        ),
    )


def measure(quick: bool) -> Sequence[Row]:
    """What the issue promised."""
    return [measure_cost("tmc5160", quick=quick), measure_cost("tmc428", quick=quick), measure_year(quick=quick)]
