"""Connections: added, edited, removed, connected, watched; names that clash; what is let go of stands still."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.devices.core.config import AxisSettings, DeviceConfig, slug, unique_slug
from app.devices.core.events import StateChanged
from app.devices.manager import DeviceChange, DeviceManager
from app.errors import OutOfRange, UnknownThing, UsageError, WrongState
from tests.devices.harness import KINDS, bench, emulator_of, state_of

EMULATED = {"kind": "emulator"}


def manager(changes: list[int] | None = None) -> DeviceManager:
    return DeviceManager(KINDS, VirtualClock(), None if changes is None else lambda: changes.append(1))


@given(names=st.lists(st.text(max_size=20), max_size=20))
def test_ids_are_fit_for_addresses_and_unique(names: list[str]) -> None:
    ids: list[str] = []
    for name in names:
        ids.append(unique_slug(name, ids))
    assert len(set(ids)) == len(ids)
    for one in ids:
        assert one.isascii()
        assert one == slug(one)


async def test_add_connects_and_two_of_a_name_have_two_ids() -> None:
    m = manager()
    first = await m.add(DeviceConfig("My Bench!", "tmc428", EMULATED))
    second = await m.add(DeviceConfig("my bench", "tmc4210", EMULATED), connect=False)
    assert [device.id for device in m.devices] == ["my-bench", "my-bench-2"]
    assert (first.state, second.state) == ("connected", "disconnected")
    assert m.get("my-bench-2") is second
    with pytest.raises(UnknownThing, match="my-bench") as caught:
        m.get("nobody")
    assert caught.value.known == ["my-bench", "my-bench-2"]
    await m.close()


@pytest.mark.parametrize(
    ("config", "error"),
    [
        ({"name": " "}, UsageError),
        ({"model": "tmc9999"}, UnknownThing),
        ({"clock_hz": 17e6}, OutOfRange),
        ({"clock_hz": float("nan")}, OutOfRange),
        ({"axes": (AxisSettings(),) * 4}, OutOfRange),
    ],
)
def test_what_is_no_connection(config: dict[str, object], error: type[Exception]) -> None:
    values: dict[str, object] = {"name": "n", "model": "tmc428", "link": EMULATED, **config}
    with pytest.raises(error):
        DeviceConfig(**values)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "settings",
    [{"gear_ratio": 0.0}, {"gear_ratio": float("inf")}, {"full_steps_per_rev": 0}, {"travel_mm_per_rev": -1.0}],
)
def test_what_is_no_axis(settings: dict[str, float]) -> None:
    with pytest.raises(OutOfRange):
        AxisSettings(**settings)  # type: ignore[arg-type]


async def test_a_link_of_no_known_kind_adds_nothing() -> None:
    m = manager()
    with pytest.raises(UnknownThing, match="telepathy"):
        await m.add(DeviceConfig("n", "tmc428", {"kind": "telepathy"}))
    assert m.devices == ()


async def test_a_new_name_keeps_the_connection_and_the_chip() -> None:
    async with bench() as b:
        edited = await b.manager.edit(
            "bench", DeviceChange(name="Other", axes=(AxisSettings(name="X", gear_ratio=2.0),))
        )
        assert edited is b.device
        assert (edited.id, edited.state, edited.axes[0].name) == ("other", "connected", "X")
        assert edited.axes[1].name == "axis 1"
        with pytest.raises(UnknownThing):
            b.manager.get("bench")
        assert (await edited.motion.move(0, 1, unit="rev")).target_position == 25_600


async def test_another_link_is_another_chip_and_the_place_in_the_list_stays() -> None:
    m = manager()
    await m.add(DeviceConfig("a", "tmc4210", EMULATED, demo=True))
    await m.add(DeviceConfig("b", "tmc4210", EMULATED))
    old = m.get("a")
    new = await m.edit("a", DeviceChange(link={"kind": "emulator", "seed": 5}))
    assert new is not old
    assert (old.state, new.state) == ("disconnected", "connected")
    assert [device.id for device in m.devices] == ["a", "b"]
    assert [config.name for config in m.configs()] == ["a", "b"]  # an edited demo device is to be kept
    with pytest.raises(UnknownThing):
        await m.edit("a", DeviceChange(link={"kind": "telepathy"}))
    assert m.get("a") is new
    await m.close()


async def test_disconnect_remove_and_connect_again() -> None:
    async with bench() as b:
        chip = b.wire
        await b.device.registers.write("v_min", 0, value=44)
        await b.manager.disconnect("bench")
        assert state_of(b.device) == "disconnected"
        for refused in (b.device.registers.read("v_min", 0), b.device.motion.move(0, 1), b.device.stop(0)):
            with pytest.raises(WrongState, match="not connected"):
                await refused
        await b.manager.connect("bench")
        assert state_of(b.device) == "connected"
        assert emulator_of(b.device) is chip  # a pulled cable does not reset a chip
        assert (await b.device.registers.read("v_min", 0)).value == 44
        await b.manager.remove("bench")
        assert b.manager.devices == ()
        assert state_of(b.device) == "disconnected"


async def test_what_we_set_in_motion_is_stopped_before_we_let_go() -> None:
    async with bench() as b:
        await b.device.motion.rotate(1, 5000)
        await b.clock.advance(1.0)
        await b.manager.disconnect("bench")
        await b.clock.advance(1.0)
        rest = b.wire.state().axes[1].position_fullsteps
        await b.clock.advance(1.0)
        assert b.wire.state().axes[1].position_fullsteps == rest


async def test_changes_are_told_and_demo_devices_are_not_kept() -> None:
    changes: list[int] = []
    m = manager(changes)
    await m.add(DeviceConfig("demo", "tmc428", EMULATED, demo=True))
    await m.add(DeviceConfig("mine", "tmc428", EMULATED))
    assert len(changes) == 2
    assert [config.name for config in m.configs()] == ["mine"]
    await m.remove("mine")
    assert len(changes) == 3
    await m.disconnect("demo")
    assert len(changes) == 3  # whether it is connected now is nothing to keep
    await m.close()


async def test_the_wrong_chip_is_a_failed_connection_with_the_reason() -> None:
    clock = VirtualClock()
    kinds = {"swapped": lambda model, link, c: KINDS["emulator"]("tmc4210" if model == "tmc428" else "tmc428", {}, c)}
    m = DeviceManager(kinds, clock)
    for model, text in (("tmc428", "TMC4210"), ("tmc4210", "no TMC4210")):
        device = await m.add(DeviceConfig(model, model, {"kind": "swapped"}))
        assert device.state == "failed"
        assert text in str(device.problem)
    await m.close()


async def test_the_state_goes_from_connecting_to_connected() -> None:
    m = manager()
    device = await m.add(DeviceConfig("d", "tmc428", EMULATED), connect=False)
    states: list[str] = []
    device.listen(lambda event: states.append(event.state) if isinstance(event, StateChanged) else None)
    await m.connect("d")
    await m.connect("d")
    await m.disconnect("d")
    assert states == ["connecting", "connected", "disconnected"]
    assert device.axes[0].pulse_div == 0


async def test_without_waiting_it_connects_in_the_background() -> None:
    clock = VirtualClock()
    m = DeviceManager(KINDS, clock)
    device = await m.add(DeviceConfig("d", "tmc428", EMULATED), wait=False)
    assert state_of(device) == "connecting"
    await clock.advance(0.0)
    assert state_of(device) == "connected"
    await m.close()
