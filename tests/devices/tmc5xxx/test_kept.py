"""What the driver knows of registers that a TMC5xxx does not tell: its ramp, CoolStep, most of the encoder."""

from __future__ import annotations

import pytest

from tests.devices.tmc5xxx.harness import MODELS, Bench, bench


def kept(b: Bench, axis: int, *groups: str) -> dict[str, int]:
    return {reading.name: reading.value for reading in b.device.registers.kept(axis, groups)}


@pytest.mark.parametrize("model", MODELS)
async def test_a_fresh_chip_is_known_to_hold_its_power_on_values(model: str) -> None:
    async with bench(model, None) as b:
        table = b.memory.table
        known = kept(b, 0)
        blind = [row for row in table if row.axis == 0 and not row.access.readable]
        assert known == {row.name: row.decode(row.reset) for row in blind if row.reset is not None}
        assert ("VMAX" in known) == (model != "tmc5240"), "that can be read"


async def test_what_is_written_is_known_by_axis_and_group() -> None:
    async with bench("tmc5072", None) as b:
        await b.device.registers.write("VMAX", 1, 777)
        await b.device.registers.write("COOLCONF", 1, fields={"semin": 3})
        assert kept(b, 1, "ramp")["VMAX"] == 777
        assert kept(b, 0, "ramp")["VMAX"] == 0
        assert "COOLCONF" not in kept(b, 1, "ramp")
        assert kept(b, 1, "driver")["COOLCONF"] == 3


async def test_a_rotation_does_not_change_the_speed_limit_that_is_known() -> None:
    async with bench() as b:
        wanted = kept(b, 0)["VMAX"]
        await b.device.motion.rotate(0, 20_000)
        assert kept(b, 0)["VMAX"] == wanted
        await b.device.stop(0)
        await b.at_rest()
        assert kept(b, 0)["VMAX"] == wanted
