"""A driver behind a TMC428: a device of its own, whose datagrams go through the controller's cover datagrams."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any, TypeVar, cast

import pytest

from app.calc.driver_chain.chain import build_chain
from app.clock import Clock, VirtualClock
from app.conditions.judge import AxisObservation, judge
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.capabilities import DriverChainRam, EventLog
from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.cover import CoverCarrier
from app.devices.core.device import Device
from app.devices.core.results import AxisState
from app.devices.core.start_up import AxisStartUp, Figures
from app.devices.manager import DeviceChange, DeviceManager
from app.devices.tmc428.start_up import AxisStart, start_up
from app.devices.tmcdrivers.family import plan
from app.emulators.build import build_emulator, options_of
from app.emulators.tmc428.device import EmulatedDevice
from app.emulators.tmc428.options import EmulatorPatch
from app.errors import LinkError, OutOfRange, UnknownThing, UsageError, WrongState
from app.links.emulator import EmulatorPort
from app.links.port import FramePort
from app.links.registry import Link

T = TypeVar("T")
DRIVERS = [{"driver": "tmc2660"}] * 3


def emulator_port(model: str, link: Link, clock: Clock) -> FramePort:
    options = {key: value for key, value in link.items() if key != "kind"}
    return EmulatorPort(build_emulator(model, clock, options_of(model).model_validate(options)))


@dataclass
class Bench:
    clock: VirtualClock
    manager: DeviceManager
    controller: Device

    async def during(self, what: Awaitable[T]) -> T:
        """While the clock goes on: a cover datagram is waited for."""
        task = asyncio.ensure_future(what)
        for _ in range(4000):
            if task.done():
                break
            await self.clock.advance(0.001)
        return await task

    async def driver(self, axis: int, **config: Any) -> Device:
        link = {"kind": "cover", "device": self.controller.id, "axis": axis}
        return await self.during(self.manager.add(DeviceConfig(f"driver {axis}", "tmc2660", link, **config)))

    async def chain(self, *drivers: str) -> None:
        made = build_chain(drivers)
        await self.controller.need(DriverChainRam).write_driver_chain(made.ram_words, made.lsmd)  # type: ignore[type-abstract, unused-ignore]

    async def set_up(self, driver: Device) -> None:
        one = AxisStartUp(0, driver.config.axes[0], Figures())
        result = await self.during(driver.registers.write_many((await plan(driver, [one])).items))
        assert result.failed is None

    def patch(self, axis: int, **change: object) -> None:
        port = cast("EmulatorPort", self.controller.session.port)
        wire = cast("EmulatedDevice", port.wire)
        wire.patch(EmulatorPatch.model_validate({"drivers": [{"axis": axis, **change}]}), port.take_turn())

    def words(self, axis: int) -> dict[int, int]:
        wire = cast("EmulatedDevice", cast("EmulatorPort", self.controller.session.port).wire)
        return wire._chip.drives.drivers[axis].words  # type: ignore[union-attr]


@asynccontextmanager
async def bench(
    drivers: Sequence[Mapping[str, object]] | None = None,
    *,
    chain: bool = True,
    model: str = "tmc428",
    **options: object,
) -> AsyncIterator[Bench]:
    clock = VirtualClock()
    manager = DeviceManager({"emulator": emulator_port}, clock)
    told = DRIVERS if drivers is None else drivers
    try:
        link: Link = {"kind": "emulator", "drivers": told, **options}
        controller = await manager.add(DeviceConfig("bench", "tmc428", link))
        made = Bench(clock, manager, controller)
        if chain:
            await made.chain(*(str(each["driver"]) for each in told))
        yield made
    finally:
        await manager.close()


async def test_each_axis_has_a_driver_with_registers_of_its_own() -> None:
    async with bench() as b:
        drivers = [await b.driver(axis) for axis in range(3)]
        assert [driver.state for driver in drivers] == ["connected"] * 3
        for axis, driver in enumerate(drivers):
            await b.set_up(driver)
            await b.during(driver.registers.write("SGCSCONF", None, fields={"CS": 10 + axis}))
        assert [b.words(axis)[6] & 0x1F for axis in range(3)] == [10, 11, 12]
        assert all(b.words(axis)[7] >> 7 & 1 for axis in range(3)), "behind a controller they are told currents"
        await b.clock.advance(0.1)
        back = await b.during(drivers[2].registers.read("DRVSTATUS_SG_SE"))
        assert back.fields["SE"] == 12
        with pytest.raises(WrongState, match="flags alone"):
            await b.during(drivers[0].registers.read("DRVSTATUS_SG_SE"))
        b.patch(0, motor={"temperature_c": 160.0})
        await b.clock.advance(0.01)
        states = [await b.during(driver.monitor.axis_state(0)) for driver in drivers]
        assert [state.flags["OT"] for state in states] == [True, False, False]
        assert states[0].mode == "currents"


async def test_the_axis_names_its_driver_and_has_only_one() -> None:
    async with bench() as b:
        driver = await b.driver(1)
        assert [(axis, each.name) for axis, each in b.controller.drivers_behind()] == [(1, "driver 1")]
        with pytest.raises(UsageError, match="axis 1 of bench has a driver already: driver 1"):
            await b.driver(1)
        await b.manager.edit(b.controller.id, DeviceChange(name="the big one"))
        assert driver.link == {"kind": "cover", "device": "the-big-one", "axis": 1}
        await b.set_up(driver)
        assert [axis for axis, _ in b.manager.drivers_of("the-big-one")] == [1]


async def test_it_does_not_matter_which_is_there_first() -> None:
    async with bench() as b:
        link = {"kind": "cover", "device": "later", "axis": 0}
        driver = await b.during(b.manager.add(DeviceConfig("early", "tmc2660", link)))
        states = [driver.state]
        assert "the controller is not there" in str(driver.problem)
        later = await b.manager.add(DeviceConfig("later", "tmc428", {"kind": "emulator", "drivers": DRIVERS[:1]}))
        await b.during(b.clock.sleep(2.0))
        states.append(driver.state)
        assert "write a chain with" in str(driver.problem), "after power-on the RAM holds noise"
        made = build_chain(["tmc2660"])
        await later.need(DriverChainRam).write_driver_chain(made.ram_words, made.lsmd)  # type: ignore[type-abstract, unused-ignore]
        await b.during(b.clock.sleep(2.0))
        states.append(driver.state)
        await b.manager.disconnect("later")
        await b.during(b.clock.sleep(3.0))
        states.append(driver.state)
        assert "not connected: connect it first" in str(driver.problem)
        await b.manager.remove("later")
        await b.during(b.clock.sleep(2.0))
        states.append(driver.state)
        assert "the controller is not there" in str(driver.problem)
        assert states == ["failed", "failed", "connected", "failed", "failed"]


async def test_a_controller_that_cannot_carry_it_says_why() -> None:
    async with bench([{"driver": "tmc236"}] * 3) as b:
        driver = await b.driver(0)
        assert driver.state == "failed"
        assert "12 bits for the driver of axis 0, this one takes 20" in str(driver.problem)
        carrier = b.controller.need(CoverCarrier)
        with pytest.raises(WrongState, match="at most 24 bits"):
            await carrier.cover(0, 40, [0])
        with pytest.raises(UnknownThing):
            await carrier.cover(3, 20, [0])
        (reply,) = await b.during(carrier.cover(2, 12, [0]))
        assert (reply.word, reply.known) == (0x100, 0xFFF)


async def test_a_driver_of_40_bits_behind_the_chain_says_what_to_do_instead() -> None:
    async with bench() as b:
        link = {"kind": "cover", "device": b.controller.id, "axis": 0}
        driver = await b.during(b.manager.add(DeviceConfig("the feed", "tmc2130", link)))
        assert driver.state == "failed"
        assert "at most 24 bits, and this driver takes 40" in str(driver.problem)
        assert "a wire of its own" in str(driver.problem)


async def test_without_a_chain_no_datagram_is_waited_for_for_ever() -> None:
    async with bench(chain=False) as b:
        with pytest.raises((LinkError, WrongState)):
            await b.during(b.controller.need(CoverCarrier).cover(0, 20, [0]))


def judged(device: Device, axis: int, state: AxisState) -> tuple[str, str]:
    found = judge(AxisObservation(axis, "connected", state=state, signs=device.monitor.signs(axis, state)))
    return found.kind, found.cause


@pytest.mark.parametrize(
    ("change", "kind", "cause", "event"),
    [
        ({"motor": {"temperature_c": 160.0}}, "driver_fault", "driver 1 is too hot", "driver_OT"),
        ({"motor": {"temperature_c": 110.0}}, "moving", "it moves to 0; driver 1 warns that it is hot", "driver_OTPW"),
        ({"motor": {"connected": False}}, "driver_fault", "driver 1 finds no load at coils A and B", "driver_OLA"),
        (
            {"motor": {"short_to_ground": "b"}},
            "driver_fault",
            "driver 1 sees a short to ground at phase B",
            "driver_S2GB",
        ),
        ({"blocked": True}, "stalled", "driver 1 tells of a stall", "driver_SG"),
    ],
)
async def test_the_right_axis_says_within_two_cycles_of_the_chain_what_its_driver_tells(
    change: dict[str, object], kind: str, cause: str, event: str
) -> None:
    async with bench() as b:
        drivers = [await b.driver(axis) for axis in range(3)]
        for driver in drivers:
            await b.set_up(driver)
            await b.during(driver.registers.write("SGCSCONF", None, fields={"CS": 20, "sgt": 0, "sfilt": 0}))
        start = AxisStart(v_max=1000, a_max=200, pulse_div=6, ramp_div=8)
        await start_up(b.controller, [start] * 3, ["tmc2660"] * 3)
        await b.during(drivers[0].identity.refresh())
        for axis in range(3):
            await b.during(b.controller.motion.rotate(axis, 2400.0))
        await b.clock.advance(1.0)
        monitor = b.controller.monitor
        for _ in range(2):
            states = [await monitor.axis_state(axis) for axis in range(3)]
            await b.clock.advance(0.001)
        assert [judged(b.controller, axis, states[axis])[0] for axis in range(3)] == ["moving"] * 3
        b.patch(1, **change)
        if "blocked" in change:
            await b.clock.advance(0.1)  # a full step has to go by before the driver itself knows
        cycles = 0
        for _ in range(2):
            await monitor.axis_state(0)
            await b.clock.advance(0.001)
            cycles += 1
        states = [await monitor.axis_state(axis) for axis in range(3)]
        found = [judged(b.controller, axis, states[axis]) for axis in range(3)]
        assert [one[0] for one in found] == ["moving", kind, "moving"]
        assert found[1][1].startswith(cause)
        log = b.controller.need(EventLog)  # type: ignore[type-abstract, unused-ignore]
        names = [{name for entry in log.events(axis).events for name in entry.names} for axis in range(3)]
        assert [event in each for each in names] == [False, True, False]
        assert cycles == 2


PRESENT, OT, OTPW, UV, OCHS, OLB, OLA, OCB, OCA = 1 << 8, 1 << 7, 1 << 6, 1 << 5, 1 << 4, 1 << 3, 1 << 2, 1 << 1, 1
UNLOADED = PRESENT | 5 << 9


@asynccontextmanager
async def turning_tmc246(v_pps: float = 2400.0) -> AsyncIterator[Bench]:
    """Three drivers without registers, whose axes turn at `v_pps` [pps], 16 microsteps each."""
    async with bench([{"driver": "tmc236"}] * 3, chain=False) as b:
        start = AxisStart(v_max=2047, a_max=2000, pulse_div=3, ramp_div=5, usrs=4)
        await start_up(b.controller, [start] * 3, ["tmc246"] * 3)
        for axis in range(3):
            b.patch(axis, status=UNLOADED)
            await b.during(b.controller.motion.rotate(axis, v_pps))
        await b.clock.advance(1.0)
        yield b


async def looked(b: Bench) -> list[AxisState]:
    """Behind two cycles of the chain."""
    for _ in range(2):
        states = [await b.controller.monitor.axis_state(axis) for axis in range(3)]
        await b.clock.advance(0.001)
    return states


@pytest.mark.sheet("DS-TMC428", "9.1")
@pytest.mark.parametrize(
    ("status", "kind", "cause", "flags"),
    [
        (OT | OTPW, "driver_fault", "the driver of axis 1 is too hot and has switched off", "OT OTPW"),
        (OTPW, "moving", "it moves to 0; the driver of axis 1 warns that it is hot", "OTPW"),
        (UV, "driver_fault", "the driver of axis 1 has too little supply voltage", "UV"),
        (OCHS, "driver_fault", "the driver of axis 1 sees too much current on its high side", "OCHS"),
        (OCA, "driver_fault", "the driver of axis 1 sees too much current in coil A", "OCA"),
        (OCB, "driver_fault", "the driver of axis 1 sees too much current in coil B", "OCB"),
        (OLA | OLB, "driver_fault", "the driver of axis 1 finds no load at coils A and B", "OLA OLB"),
    ],
)
async def test_status_bits_of_a_driver_without_registers_are_told_by_name(
    status: int, kind: str, cause: str, flags: str
) -> None:
    async with turning_tmc246() as b:
        states = await looked(b)
        assert [judged(b.controller, axis, states[axis])[0] for axis in range(3)] == ["moving"] * 3
        assert (states[1].flags["driver_LD2"], states[1].flags["driver_LD1"], states[1].flags["driver_LD0"]) == (
            1,
            0,
            1,
        )
        b.patch(1, status=UNLOADED | status)
        states = await looked(b)
        found = [judged(b.controller, axis, states[axis]) for axis in range(3)]
        assert [one[0] for one in found] == ["moving", kind, "moving"]
        assert found[1][1].startswith(cause)
        log = b.controller.need(EventLog)  # type: ignore[type-abstract, unused-ignore]
        told = [{name for entry in log.events(axis).events for name in entry.names} for axis in range(3)]
        assert told[1] >= {f"driver_{name}" for name in flags.split()}
        assert not any(name.startswith("driver_") for name in told[0] | told[2])


async def test_a_load_value_of_0_is_told_of_a_driver_that_measures_one() -> None:
    async with turning_tmc246(16_000.0) as b:
        b.patch(2, status=PRESENT)  # a TMC236: its load bits are always 0
        await looked(b)
        b.patch(1, status=PRESENT)
        states = await looked(b)
        found = [judged(b.controller, axis, states[axis]) for axis in range(3)]
        assert [one[0] for one in found] == ["moving", "stalled", "moving"]
        assert "measures its greatest load (LD 0)" in found[1][1]


async def test_covers_that_a_user_sends_by_hand_are_left_alone_and_their_answers_count() -> None:
    async with turning_tmc246() as b:
        await b.controller.registers.write("cover_pos_cover_len", fields={"cover_len": 7, "cover_pos": 3})
        b.patch(0, status=UNLOADED | UV)
        states = await looked(b)
        assert not states[0].flags.get("driver_UV")
        held = await b.controller.registers.read("cover_pos_cover_len")
        assert (held.fields["cover_len"], held.fields["cover_pos"]) == (7, 3 + 1), "it reads back one more"
        await b.controller.registers.write("cover_datagram", value=0)
        await b.clock.advance(0.01)
        assert (await looked(b))[0].flags["driver_UV"]


async def test_without_named_drivers_the_cover_registers_are_left_alone() -> None:
    async with bench() as b:
        await b.controller.registers.write("cover_pos_cover_len", fields={"cover_len": 7, "cover_pos": 3})
        state = await b.controller.monitor.axis_state(0)
        held = await b.controller.registers.read("cover_pos_cover_len")
        assert held.fields["cover_len"] == 7
        assert not any(name.startswith("driver_") for name in state.flags)


@pytest.mark.parametrize(
    ("link", "error", "told"),
    [
        ({"device": "bench", "axis": 8}, OutOfRange, "axis"),
        ({"device": ""}, UsageError, "needs the device"),
        ({"device": "bench", "speed": 1}, UnknownThing, "speed"),
    ],
)
async def test_a_link_that_cannot_be_is_refused(link: dict[str, object], error: type[Exception], told: str) -> None:
    async with bench(chain=False) as b:
        with pytest.raises(error, match=told):
            await b.manager.add(DeviceConfig("driver", "tmc2660", {"kind": "cover", **link}))
        with pytest.raises(UsageError, match="has no cover link"):
            await b.manager.add(DeviceConfig("driver", "tmc2209", {"kind": "cover", "device": "bench"}))


async def test_a_stop_of_the_controller_does_not_wait_for_the_driver() -> None:
    async with bench() as b:
        driver = await b.driver(2)
        await b.set_up(driver)
        order: list[str] = []
        reading = asyncio.ensure_future(driver.registers.read("DRVSTATUS_SG"))
        reading.add_done_callback(lambda _: order.append("read"))
        await asyncio.sleep(0)
        stopping = asyncio.ensure_future(b.controller.stop_axes([0, 1, 2]))
        stopping.add_done_callback(lambda _: order.append("stopped"))
        await b.during(asyncio.gather(reading, stopping))
        assert all(outcome.ok for outcome in stopping.result())
        assert order == ["stopped", "read"]


async def test_limits_of_the_driver_hold_behind_a_controller_too() -> None:
    async with bench() as b:
        axis = AxisSettings(limits=AxisLimits(current_max_a=1.0, sense_resistor_ohm=0.1))
        driver = await b.driver(0, axes=(axis,))
        with pytest.raises(UsageError, match="soft limit"):
            await b.during(driver.registers.write("SGCSCONF", None, fields={"CS": 31}))
