"""Moves of several devices that start together: judged before anything goes out, by one edge or by commands, and the
skew that is told is the true one."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any, cast

import pytest

from app.clock import Clock, VirtualClock
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.device import Device
from app.devices.core.results import AxisMove
from app.devices.manager import DeviceChange, DeviceManager
from app.devices.tmc428.start_up import AxisStart, start_up
from app.emulators.build import build_emulator, family_of, options_of
from app.emulators.tmc4361 import EmulatedTmc4361
from app.emulators.wiring import EmulatorWiring, Present
from app.errors import BenchError, LinkTimeout, SoftLimit, UsageError, WrongState
from app.links.emulator import EmulatorPort
from app.links.port import FramePort
from app.links.registry import Link
from app.procedures.procedures import Procedures
from app.procedures.start_together import StartNet, TogetherMove, TogetherStart

LOOK_S = 1e-4
"""How often the truth is looked at [s]."""
TICKS_S = 2 * 64 / 16e6
RAMP = {"CLK_FREQ": 16_000_000, "AMAX": 800_000, "DMAX": 800_000, "VSTART": 256 * 2000, "RAMPMODE": 5}
VMAX = 20_000


class SlowPort(EmulatorPort):
    """An emulator behind a wire on which each exchange takes a while, half of it there and half back."""

    def __init__(self, wire: Any, clock: Clock, takes_s: float) -> None:
        super().__init__(wire)
        self._clock, self.takes_s = clock, takes_s
        self.frames: list[bytes] = []
        self.before_frame: Callable[[bytes], None] = lambda _: None

    def _answer(self, frame: bytes, at_s: float) -> bytes:
        self.frames.append(frame)
        self.before_frame(frame)
        return super()._answer(frame, at_s)

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        await self._clock.sleep(self.takes_s / 2)
        answer = await super().exchange(frame, timeout_s)
        await self._clock.sleep(self.takes_s / 2)
        return answer

    async def exchange_chain(self, frames: Any, timeout_s: float | None = None) -> list[bytes]:
        await self._clock.sleep(self.takes_s / 2)
        answers = await super().exchange_chain(frames, timeout_s)
        await self._clock.sleep(self.takes_s / 2)
        return answers


@dataclass
class Bench:
    clock: VirtualClock
    manager: DeviceManager
    wiring: EmulatorWiring
    procedures: Procedures

    def device(self, name: str) -> Device:
        return self.manager.get(name)

    def port(self, name: str) -> SlowPort:
        return cast("SlowPort", self.device(name).session.port)

    def chip(self, name: str) -> EmulatedTmc4361:
        return cast("EmulatedTmc4361", self.port(name).wire)

    @property
    def nets(self) -> list[StartNet]:
        return [
            StartNet([pin.key for pin in net.pins], net.seen_within_s) for net in self.wiring.nets if net.open is None
        ]

    def wire(self, net: str, *pins: tuple[str, str]) -> None:
        """Have these pins on a net."""
        self.wiring.assign(net, pins)
        sync(self.wiring, self.manager)

    def touch(self, name: str, *, left: bool) -> None:
        """Have the left switch of the first axis closed or open."""
        wire: Any = self.port(name).wire
        switches: Any = {"left": left} if self.device(name).model == "tmc4361" else [{"axis": 0, "left": left}]
        wire.patch(family_of(wire.model).patch.model_validate({"switches": switches}))

    async def start(self, targets: dict[tuple[str, int], int], **options: Any) -> TogetherStart:
        """Let time pass until they have started."""
        moves = [TogetherMove(self.device(name), AxisMove(axis, at)) for (name, axis), at in targets.items()]
        nets = options.pop("nets", self.nets)
        task = asyncio.create_task(self.procedures.start_together(moves, nets, **options))
        for _ in range(100_000):
            await self.clock.advance(1e-4)
            if task.done():
                return task.result()
        raise AssertionError("it does not start")

    async def at_rest(self) -> dict[tuple[str, int], int]:
        for _ in range(400):
            await self.clock.advance(0.05)
            states = {
                (device.id, axis.index): await self.reading(device, axis.index)
                for device in self.manager.devices
                for axis in device.axes
            }
            if not any(state.moving for state in states.values()):
                return {at: state.position for at, state in states.items()}
        raise AssertionError("they still move")

    async def reading(self, device: Device, axis: int) -> Any:
        task = asyncio.create_task(device.monitor.axis_state(axis))
        while not task.done():
            await self.clock.advance(1e-3)
        return task.result()


def sync(wiring: EmulatorWiring, manager: DeviceManager) -> None:
    ports = [(device.id, cast("EmulatorPort", device.session.port)) for device in manager.devices]
    wiring.sync([Present(key, port.wire, port) for key, port in ports])


@asynccontextmanager
async def bench(*models: str, takes_s: tuple[float, ...] = (), wired: bool = False) -> AsyncIterator[Bench]:
    """Devices `a`, `b`, ... that are set up to move."""
    clock, wiring = VirtualClock(), EmulatorWiring()

    def port(model: str, link: Link, clock: Clock) -> FramePort:
        options = options_of(model).model_validate({key: link[key] for key in link if key not in ("kind", "takes_s")})
        return SlowPort(build_emulator(model, clock, options), clock, 0.0)

    def changed() -> None:
        sync(wiring, manager)

    manager = DeviceManager({"emulator": port}, clock, on_change=changed)
    for name, model in zip("abcdef", models, strict=False):
        link: dict[str, Any] = {"kind": "emulator"}
        if wired and model == "tmc4361":
            link["wires"] = [{"pin": "START", "net": "start"}]
        device = await manager.add(DeviceConfig(name, model, link))
        assert device.state == "connected", device.problem
        if model == "tmc4361":
            for register, value in RAMP.items():
                await device.registers.write(register, 0, value)
            await device.registers.write("VMAX", 0, VMAX * 256)
        elif model.startswith("tmc42"):
            await start_up(device, [AxisStart(v_max=1500, a_max=200, pulse_div=4, ramp_div=6)] * len(device.axes))
        else:
            for register, value in (("A1", 1000), ("AMAX", 1000), ("DMAX", 1000), ("D1", 1000), ("VMAX", 20_000)):
                await device.registers.write(register, 0, value)
            await device.registers.write("VSTOP", 0, 10)
        await clock.advance(0.00123)
    made = Bench(clock, manager, wiring, Procedures(clock))
    for name, each_s in zip("abcdef", takes_s, strict=False):
        made.port(name).takes_s = each_s
    try:
        yield made
    finally:
        for device in manager.devices:
            cast("SlowPort", device.session.port).takes_s = 0.0
        await manager.close()


async def first_steps_s(b: Bench, names: str, task: asyncio.Task[TogetherStart]) -> dict[str, float]:
    """The truth: when each emulated chip made its first step, looked for at each `LOOK_S`."""
    found: dict[str, float] = {}
    for _ in range(5000):
        await b.clock.advance(LOOK_S)
        for name in set(names) - found.keys():
            if b.chip(name).state().step_output.steps_sent:
                found[name] = b.clock.now()
        if task.done() and len(found) == len(names):
            return found
    raise AssertionError(f"only {found} move")


@pytest.mark.parametrize("takes_s", [(0.0, 0.0, 0.0), (1e-3, 4e-3, 2.5e-3), (7e-3, 0.5e-3, 3e-3)])
async def test_unwired_the_skew_told_is_the_true_one(takes_s: tuple[float, ...]) -> None:
    async with bench(*["tmc4361"] * 3, takes_s=takes_s) as b:
        moves = [TogetherMove(b.device(name), AxisMove(0, 4000)) for name in "abc"]
        task = asyncio.create_task(b.procedures.start_together(moves, b.nets))
        truth = await first_steps_s(b, "abc", task)
        told = task.result()
        assert [axis.how for axis in told.axes] == ["command"] * 3
        first_s = min(truth.values())
        for axis in told.axes:
            true_s = truth[axis.device] - first_s
            assert abs(axis.skew_s - true_s) <= axis.uncertainty_s + TICKS_S + LOOK_S, (axis, truth)
        assert told.spread_s == pytest.approx(max(truth.values()) - first_s, abs=TICKS_S + LOOK_S)
        if any(takes_s):
            assert told.spread_s > 0.5e-3, "links of different speed are told apart"
        assert set((await b.at_rest()).values()) == {4000}


@pytest.mark.parametrize("takes_s", [(0.0, 0.0, 0.0), (1e-3, 4e-3, 2.5e-3)])
async def test_wired_chips_start_in_one_clock_whatever_their_links_take(takes_s: tuple[float, ...]) -> None:
    async with bench(*["tmc4361"] * 3, takes_s=takes_s, wired=True) as b:
        before = {name: await registers(b, name) for name in "abc"}
        moves = [TogetherMove(b.device(name), AxisMove(0, 4000)) for name in "abc"]
        task = asyncio.create_task(b.procedures.start_together(moves, b.nets))
        truth = await first_steps_s(b, "abc", task)
        told = task.result()
        assert set(truth.values()) == {truth["a"]}
        for _ in range(50):  # not a clock apart: a clock is 1.2e-4 microsteps or more
            await b.clock.advance(0.00123)
            assert len({round(b.chip(name).state().ramp.position, 6) for name in "abc"}) == 1
        assert {(axis.how, axis.skew_s, axis.uncertainty_s) for axis in told.axes} == {("START wire", 0.0, 0.0)}
        assert all(axis.warnings == [] for axis in told.axes)
        assert {name: await registers(b, name) for name in "abc"} == before, "what was borrowed is given back"
        assert set((await b.at_rest()).values()) == {4000}
        again = await b.start({("b", 0): 100, ("c", 0): 200})
        assert [axis.how for axis in again.axes] == ["START wire"] * 2
        assert await b.at_rest() == {("a", 0): 4000, ("b", 0): 100, ("c", 0): 200}


async def registers(b: Bench, name: str) -> list[int]:
    task = asyncio.gather(*(b.device(name).registers.read(row, 0) for row in ("START_CONF", "POS_COMP", "START_DELAY")))
    while not task.done():
        await b.clock.advance(1e-3)
    return [reading.raw for reading in task.result()]


async def test_six_axes_on_four_chips_by_wire_and_by_command() -> None:
    async with bench("tmc4361", "tmc429", "tmc4361", "tmc4361", wired=True) as b:
        targets = {("a", 0): 1000, ("b", 0): 2000, ("b", 1): -2000, ("b", 2): 500, ("c", 0): 1500, ("d", 0): -700}
        told = await b.start(targets)
        assert [(axis.device, axis.axis) for axis in told.axes] == list(targets)
        wired = [axis for axis in told.axes if axis.how == "START wire"]
        assert {axis.device for axis in wired} == {"a", "c", "d"}
        assert len({axis.skew_s for axis in wired}) == 1
        assert await b.at_rest() == targets


async def test_other_families_start_together_too() -> None:
    async with bench("tmc5160", "tmc4210", "tmc428") as b:
        targets = {("a", 0): 3000, ("b", 0): 2000, ("c", 1): -2000}
        told = await b.start(targets)
        assert {axis.how for axis in told.axes} == {"command"}
        at = await b.at_rest()
        assert {key: at[key] for key in targets} == targets


@pytest.mark.parametrize("wired", [False, True])
async def test_what_is_beyond_a_limit_lets_nobody_start(wired: bool) -> None:
    async with bench(*["tmc4361"] * 2, "tmc4210", wired=wired) as b:
        limited = AxisSettings(name="X", limits=AxisLimits(position_min=-1000, position_max=1000))
        await b.manager.edit("c", DeviceChange(axes=(limited,)))
        before = {name: await registers(b, name) for name in "ab"}
        with pytest.raises(SoftLimit):
            await b.start({("a", 0): 500, ("b", 0): 500, ("c", 0): 2000})
        assert set((await b.at_rest()).values()) == {0}
        assert {name: await registers(b, name) for name in "ab"} == before
        assert {b.chip(name).state().step_output.steps_sent for name in "ab"} == {0}
        await b.start({("a", 0): 500, ("b", 0): 500, ("c", 0): 900})
        assert set((await b.at_rest()).values()) == {500, 900}


@pytest.mark.parametrize("wired", [False, True])
async def test_a_stop_while_they_get_ready_lets_nobody_start(wired: bool) -> None:
    async with bench(*["tmc4361"] * 3, takes_s=(0.0, 0.0, 0.05), wired=wired) as b:
        moves = [TogetherMove(b.device(name), AxisMove(0, 4000)) for name in "abc"]
        task = asyncio.create_task(b.procedures.start_together(moves, b.nets))
        await b.clock.advance(0.03)
        assert not task.done()
        stop = asyncio.create_task(b.manager.stop_axis(b.device("a"), 0))
        await b.clock.advance(0)
        assert stop.done(), "the stop does not wait for the others"
        assert stop.result().ok
        for _ in range(100):
            await b.clock.advance(0.05)
        with pytest.raises(WrongState, match="overtook"):
            task.result()
        assert set((await b.at_rest()).values()) == {0}
        assert {b.chip(name).state().step_output.steps_sent for name in "abc"} == {0}


async def test_a_wire_that_is_not_there_stops_those_that_started() -> None:
    async with bench(*["tmc4361"] * 2) as b:
        with pytest.raises(WrongState, match="b did not start"):
            await b.start({("a", 0): 400_000, ("b", 0): 400_000}, nets=[StartNet(["a", "b"], 0.0)])
        at = await b.at_rest()
        assert at["b", 0] == 0
        assert abs(at["a", 0]) < 20_000, "what had started was stopped"
        assert b.chip("b").state().step_output.steps_sent == 0


async def test_a_chip_that_falls_silent_is_asked_nothing_twice_and_the_others_stop() -> None:
    async with bench(*["tmc4361"] * 2) as b:
        xtarget = 0x37 | 0x80

        def silent(frame: bytes) -> None:
            if frame[0] == xtarget and int.from_bytes(frame[1:], "big") == 400_000:
                b.chip("b").faults.silence = True

        b.port("b").before_frame = silent
        with pytest.raises(LinkTimeout):
            await b.start({("a", 0): 400_000, ("b", 0): 400_000})
        sent = [
            frame for frame in b.port("b").frames if frame[0] == xtarget and frame[1:] == (400_000).to_bytes(4, "big")
        ]
        assert len(sent) == 1
        b.chip("b").faults.silence = False
        await b.clock.advance(0.5)
        assert abs(b.chip("a").state().ramp.position) < 20_000


async def test_what_cannot_start_together_is_refused() -> None:
    async with bench("tmc4361", "tmc4210") as b:
        for moves, error in (
            ([], UsageError),
            ([TogetherMove(b.device("a"), AxisMove(0, 1))] * 2, UsageError),
            ([TogetherMove(b.device("a"), AxisMove(1, 1))], BenchError),
        ):
            with pytest.raises(error):
                await b.procedures.start_together(moves, [])
        b.procedures.start_shuttle(b.device("b"), 0, 0, 500)
        with pytest.raises(WrongState, match="shuttle runs"):
            await b.procedures.start_together([TogetherMove(b.device("b"), AxisMove(0, 1))], [])
        await b.procedures.close()
