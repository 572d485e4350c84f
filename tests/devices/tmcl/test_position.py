"""The position of a module's axis called by another number: read back, and nothing moves."""

from __future__ import annotations

import pytest

from app.devices.core.capabilities import PositionSetting
from app.errors import OutOfRange, WrongState
from tests.devices.tmcl.harness import bench


@pytest.mark.parametrize("model", ["pd42-1241", "tmcm-1161"])
async def test_a_place_is_called_by_another_number_and_the_motor_stays(model: str) -> None:
    async with bench(model) as b:
        await b.device.motion.move(0, 1000)
        assert await b.at_rest() == 1000
        assert await b.device.need(PositionSetting).set_position(0, -250) == 1250
        await b.clock.advance(1.0)
        state = await b.device.monitor.axis_state(0)
        assert (state.position, state.moving) == (-250, False)
        await b.device.motion.move(0, 0)
        assert await b.at_rest() == 0


async def test_not_while_it_moves_nor_beyond_what_it_counts() -> None:
    async with bench("tmcm-1161") as b:
        setting = b.device.need(PositionSetting)
        with pytest.raises(OutOfRange):
            await setting.set_position(0, 1 << 23)
        await b.device.motion.rotate(0, 2000.0)
        await b.clock.advance(0.5)
        with pytest.raises(WrongState, match="moves"):
            await setting.set_position(0, 0)
