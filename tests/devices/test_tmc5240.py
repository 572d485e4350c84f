"""The driver of a TMC5240: settings that can be read, currents by ranges, ramps of eight points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.core.start_up import Figures
from app.devices.manager import DeviceChange
from app.devices.tmc5xxx.start_up import start_items
from app.errors import CannotMove, UsageError
from app.profiles.diff import Difference
from app.profiles.start_up import StartUpRequest, dry_run

from .tmc5xxx.harness import START, Bench, bench

FULL_SCALE_A = 3 / 2**0.5
"""With 12 kOhm at IREF, RMS."""
FURTHER = {"TVMAX": 2000, "V2": 40_000, "A2": 3000, "D2": 4000}


async def put(made: Bench, **values: int) -> None:
    for name, value in values.items():
        await made.device.registers.write(name, 0, value)


async def value(made: Bench, name: str) -> int:
    return (await made.device.registers.read(name, 0)).value


def word_of(difference: Difference) -> int:
    assert isinstance(difference.right, int)
    return difference.right


async def test_it_moves_by_eight_points_as_predicted() -> None:
    async with bench("tmc5240") as b:
        await put(b, V1=20_000, A1=6000, D1=8000, **FURTHER)
        started = await b.device.motion.move(0, 60_000)
        assert started.predicted_duration_s is not None
        await b.clock.advance(started.predicted_duration_s / 2)
        state = await b.state()
        expected = b.device.motion.prediction(0)
        assert expected is not None
        position, velocity = expected.at(np.asarray([state.time_s]))
        assert state.position == pytest.approx(float(position[0]), abs=40)
        assert state.velocity_pps == pytest.approx(float(velocity[0]), rel=0.01)
        await b.clock.advance(started.predicted_duration_s / 2 + 1e-3)
        assert (await b.state()).position == 60_000
        words = b.ramp().words
        assert {name: words[name] for name in FURTHER} == FURTHER


async def test_what_a_stop_has_written_over_is_shown_as_the_user_set_it() -> None:
    async with bench("tmc5240") as b:
        wanted = await value(b, "VMAX")
        await b.device.motion.rotate(0, 20_000)
        await b.clock.advance(0.1)
        await b.device.motion.stop_axes([0], "ramp")
        await b.at_rest()
        assert b.wire.read(b.address("VMAX")) == 0
        assert await value(b, "VMAX") == wanted
        await b.device.motion.move(0, 1000)
        assert b.wire.read(b.address("VMAX")) == wanted


async def test_settings_from_before_this_connection_are_read() -> None:
    async with bench("tmc5240") as b:
        await b.manager.disconnect(b.device.id)
        for name, word in {"VMAX": 12_345, "AMAX": 999, "V2": 5000, "A2": 77}.items():
            b.wire.write(b.address(name), word)
        await b.manager.connect(b.device.id)
        assert {name: b.ramp().words[name] for name in ("VMAX", "AMAX", "V2", "A2")} == {
            "VMAX": 12_345,
            "AMAX": 999,
            "V2": 5000,
            "A2": 77,
        }


async def test_a_segment_that_leads_nowhere_is_refused() -> None:
    async with bench("tmc5240") as b:
        await put(b, V2=30_000, A2=0)
        with pytest.raises(CannotMove, match="A2 is 0, and nothing gets it to V2"):
            await b.device.motion.move(0, 1000)


@pytest.mark.parametrize(("run_a", "current_range"), [(0.5, 0), (1.2, 1), (2.0, 2)])
async def test_a_start_takes_the_lowest_range_that_suffices(run_a: float, current_range: int) -> None:
    async with bench("tmc5240", start=None) as b:
        limits = AxisLimits(current_full_scale_a=FULL_SCALE_A)
        await b.manager.edit(b.device.id, DeviceChange(axes=(replace(b.device.axes[0].settings, limits=limits),)))
        tried = await dry_run(b.device, StartUpRequest(figures=Figures(run_current_a=run_a)))
        written = {one.name: one for one in tried.diff.differences}
        ranges = written.get("DRV_CONF")
        assert (
            0 if ranges is None else b.memory.table.get("DRV_CONF", 0).unpack(word_of(ranges))["CURRENT_RANGE"]
        ) == current_range
        full_a = FULL_SCALE_A * (11.75 / 36, 24 / 36, 1)[current_range]
        irun = b.memory.table.get("IHOLD_IRUN", 0).unpack(word_of(written["IHOLD_IRUN"]))["IRUN"]
        assert run_a - full_a / 32 <= full_a * (irun + 1) / 32 <= run_a


async def test_its_start_leaves_the_further_corners_out() -> None:
    async with bench("tmc5240") as b:
        items = {item.name: item.value for item in start_items(b.device, 0, START)}
        assert [items[name] for name in ("TVMAX", "V2", "A2")] == [0, 0, 0]
        assert items["D2"] == items["D1"]


async def test_a_word_out_of_range_is_named() -> None:
    async with bench("tmc5240") as b:
        with pytest.raises(UsageError, match="A2"):
            await put(b, A2=1 << 18)
