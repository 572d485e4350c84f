"""When the twin runs, what it is told and how often."""

from __future__ import annotations

import asyncio
import gc
import subprocess
import sys
import weakref

import numpy as np
import pytest

from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.manager import DeviceChange
from app.errors import UnknownThing, WrongState
from app.twin.process import Renderer, TwinFailed
from app.twin.recorded import RecordedAxis
from app.twin.service import UPDATES_PER_S, VIEWERS_MAX, Twin
from app.twin.shape import Shape
from tests.twin.conftest import IDLE_S, Rig


async def test_off_nothing_runs_and_nothing_reads(rig: Rig) -> None:
    await rig.clock.advance(5.0)
    assert (rig.twin.info.state, rig.renderers, rig.hub.readers) == ("off", [], 0)
    with pytest.raises(WrongState, match="off"):
        _ = rig.twin.address


def test_the_server_does_not_even_import_viser() -> None:
    code = "import app.twin.service, app.api.twin.proxy, sys; sys.exit('viser' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


async def test_it_shows_the_axis_while_somebody_looks(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0, "dark")
    with rig.twin.looking():
        await rig.clock.advance(0.3)
        first = rig.renderer.told[0][1]
        assert (first["shape"]["device"], first["shape"]["travel_mm_per_rev"], first["scheme"]) == ("chip", 8.0, "dark")
        assert rig.renderer.look["position"] == 0.0
        await rig.device.motion.move(0, 25_600)
        await rig.clock.advance(4.0)
        look = rig.renderer.look
        assert look["position"] == 25_600.0
        assert look["place_commanded"] == pytest.approx(4.0)
        assert look["place_measured"] == pytest.approx(4.0, abs=0.01)
        assert look["field_from"] == "mscnt"
        assert rig.twin.info.look is not None


async def test_never_more_than_thirty_updates_a_second(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    with rig.twin.looking():
        await rig.device.motion.rotate(0, 20_000.0)
        await rig.clock.advance(2.5)
    looks_s = np.array(rig.renderer.looks_s)
    for begin_s in looks_s:
        assert np.count_nonzero((looks_s >= begin_s) & (looks_s < begin_s + 1.0 - 1e-9)) <= UPDATES_PER_S
    assert rig.twin.info.updates_per_s == pytest.approx(UPDATES_PER_S, abs=2)


async def test_a_slow_renderer_gets_the_latest_and_no_more_than_it_takes(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    rig.renderer.takes_s = 0.2
    with rig.twin.looking():
        await rig.device.motion.rotate(0, 20_000.0)
        await rig.clock.advance(2.5)
        assert 3.0 <= rig.twin.info.updates_per_s <= 5.0
        age_s = rig.device.device_time_s() - rig.renderer.look["time_s"]
        assert age_s < 0.3


async def test_at_rest_little_is_told(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    with rig.twin.looking():
        await rig.clock.advance(1.0)
        told = len(rig.renderer.looks_s)
        await rig.clock.advance(2.0)
        assert len(rig.renderer.looks_s) == told
        assert rig.twin.info.updates_per_s == 0.0


async def test_it_ends_when_nobody_has_looked_for_a_while(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    with rig.twin.looking():
        await rig.clock.advance(1.2 * IDLE_S)
        assert rig.twin.info.state == "on"
    await rig.clock.advance(IDLE_S - 2.0)
    assert rig.twin.info.state == "on"
    await rig.clock.advance(4.0)
    assert (rig.twin.info.state, rig.renderer.closed, rig.hub.readers) == ("off", True, 0)


async def test_it_ends_when_told(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    await rig.twin.off()
    await rig.twin.off()
    assert (rig.twin.info.state, rig.renderer.closed, rig.hub.readers) == ("off", True, 0)
    await rig.twin.show(rig.device, 0)
    assert (rig.twin.info.state, len(rig.renderers)) == ("on", 2)


async def test_another_axis_uses_the_process_that_runs(rig: Rig) -> None:
    pair = await rig.manager.add(DeviceConfig("pair", "tmc5072", {"kind": "emulator"}))
    await rig.twin.show(rig.device, 0)
    with rig.twin.looking():
        await rig.clock.advance(0.2)
        await rig.twin.show(pair, 1, "dark")
        await rig.clock.advance(0.2)
    shapes = [message["shape"] for _, message in rig.renderer.told if "shape" in message]
    assert [(shape["device"], shape["axis"]) for shape in shapes] == [("chip", 0), ("pair", 1)]
    assert len(rig.renderers) == 1
    assert rig.hub.readers == 1
    with pytest.raises(UnknownThing):
        await rig.twin.show(pair, 2)


async def test_several_who_start_it_at_once_get_one(rig: Rig) -> None:
    await asyncio.gather(*(rig.twin.show(rig.device, 0) for _ in range(5)))
    assert len(rig.renderers) == 1


async def test_a_process_that_ends_is_told_with_a_way_out(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    rig.renderer.broken = "was ended by signal 9"
    with rig.twin.looking():
        await rig.clock.advance(0.5)
        info = rig.twin.info
        assert info.state == "failed"
        assert isinstance(info.problem, TwinFailed)
        assert "signal 9" in str(info.problem)
        assert info.problem.way_out
        assert rig.renderer.closed
    await rig.twin.show(rig.device, 0)
    assert rig.twin.info.state == "on"
    assert rig.twin.info.problem is None


async def test_its_end_is_noticed_also_while_nothing_changes(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    with rig.twin.looking():
        await rig.clock.advance(1.0)
        rig.renderer.dead.set()
        await rig.clock.advance(0.3)
        assert rig.twin.info.state == "failed"
        assert "signal 9" in str(rig.twin.info.problem)


async def test_one_that_does_not_start_is_told_to_whoever_asked(rig: Rig) -> None:
    async def start() -> Renderer:
        raise TwinFailed("could not be started: no such file")

    twin = Twin(rig.clock, rig.hub, start)
    with pytest.raises(TwinFailed):
        await twin.show(rig.device, 0)
    assert twin.info.state == "failed"
    assert rig.hub.readers == 0


async def test_a_device_that_goes_leaves_a_grey_picture_and_a_reason(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    with rig.twin.looking():
        await rig.clock.advance(0.5)
        await rig.manager.remove("chip")
        await rig.clock.advance(0.5)
        assert "position" not in rig.renderer.look
        assert rig.twin.info.state == "on"
        assert rig.twin.info.problem is not None
        assert rig.twin.info.shape is not None
        assert rig.twin.info.shape.device == "chip"
        await rig.clock.advance(2.0)
        assert rig.twin.info.state == "on"


async def test_a_device_that_goes_is_not_kept_for_its_picture(rig: Rig) -> None:
    config = DeviceConfig("other", "tmc428", {"kind": "emulator"}, axes=(AxisSettings(),) * 3)
    other = weakref.ref(await rig.manager.add(config))
    shown = other()
    assert shown is not None
    await rig.twin.show(shown, 1)
    del shown
    with rig.twin.looking():
        await rig.clock.advance(0.5)
        await rig.manager.remove("other")
        await rig.clock.advance(0.5)
        gc.collect()
        assert other() is None
        assert rig.twin.info.shape is not None
        assert rig.twin.info.shape.axis == 1


async def test_a_device_that_is_connected_in_another_way_is_shown_on(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    with rig.twin.looking():
        await rig.clock.advance(0.5)
        await rig.manager.edit("chip", DeviceChange(link={"kind": "emulator", "time_scale": 2.0}))
        await rig.clock.advance(2.0)
        assert rig.twin.info.problem is None
        assert rig.renderer.look["position"] == 0.0


async def test_lost_steps_are_counted_also_while_nobody_looks(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    await rig.clock.advance(1.0)
    # The shaft is turned on by a whole electrical turn, as a blow would: the encoder counts it, the chip does not.
    held = (await rig.device.registers.read("X_ENC", 0)).raw
    await rig.device.registers.write("X_ENC", 0, held - 4 * 256)
    await rig.clock.advance(1.0)
    with rig.twin.looking():
        await rig.clock.advance(0.2)
        assert rig.renderer.look["slips"]["lost_full_steps"] == 4


async def test_so_many_may_look(rig: Rig) -> None:
    await rig.twin.show(rig.device, 0)
    looks = [rig.twin.looking() for _ in range(VIEWERS_MAX)]
    for look in looks:
        look.__enter__()
    with pytest.raises(WrongState, match="look at"), rig.twin.looking():
        pass
    for look in looks:
        look.__exit__(None, None, None)
    assert rig.twin.info.viewers == 0


def a_recording() -> RecordedAxis:
    shape = Shape("chip", 0, "X", microsteps=256, travel_mm_per_rev=8.0)
    time_s = 50.0 + np.arange(1000) / 1000.0
    position = np.arange(1000.0) * 51.2
    deviation = np.where(np.arange(1000) < 600, 0.0, -1024.0)
    return RecordedAxis("r1", shape, 50.25, time_s, {"position": position, "deviation": deviation, "tstep": position})


async def test_a_cursor_shows_the_recording_and_then_what_happens_now_again(rig: Rig) -> None:
    recorded = a_recording()
    await rig.twin.show(rig.device, 0)
    with rig.twin.looking():
        await rig.twin.scrub(recorded, 0.1)
        await rig.clock.advance(0.3)
        assert rig.renderer.look["position"] == pytest.approx(350 * 51.2)
        assert rig.renderer.look["slips"]["lost_full_steps"] == 0
        assert (rig.twin.info.following, rig.twin.info.recording, rig.twin.info.recording_s) == ("recording", "r1", 0.1)
        await rig.twin.scrub(recorded, 0.5)
        await rig.clock.advance(0.1)
        assert rig.renderer.look["slips"]["lost_full_steps"] == 4
        assert rig.twin.recorded("r1") is recorded
        assert rig.twin.recorded("r2") is None
        await rig.twin.follow()
        await rig.clock.advance(0.2)
        assert rig.renderer.look["position"] == 0.0
        assert rig.twin.info.following == "telemetry"


async def test_a_recording_needs_no_device(rig: Rig) -> None:
    await rig.twin.scrub(a_recording(), 0.1, "dark")
    with rig.twin.looking():
        await rig.clock.advance(0.3)
        assert rig.renderer.look["position"] == pytest.approx(350 * 51.2)
        assert rig.hub.readers == 0
    await rig.twin.follow()  # there is nothing to follow
    assert rig.twin.info.state == "off"


def test_a_recording_answers_for_any_time() -> None:
    recorded = a_recording()
    assert recorded.span_s == pytest.approx((-0.25, 0.749))
    assert recorded.at(-1.0).position is None
    assert recorded.at(-0.25).position == 0.0
    assert recorded.at(99.0).position == pytest.approx(999 * 51.2)
    assert recorded.shape.channels == {"position", "deviation"}
    # Scrubbing back takes back what was lost later.
    assert [recorded.at(at_s).slips for at_s in (0.6, 0.1)] != [recorded.at(0.6).slips] * 2
