"""The microstep table, and the configuration as a document, of registers that cannot be read."""

from __future__ import annotations

from app.calc.microsteps.mslut import POWER_ON, decode, encode
from app.devices.core.capabilities import MslutTable
from tests.devices.tmc4361.harness import bench


async def test_the_table_is_the_one_of_power_on_until_it_is_written() -> None:
    async with bench() as b:
        held = await b.device.need(MslutTable).read_mslut()
        assert held.registers == POWER_ON
        assert held.written is False


async def test_what_is_written_is_what_the_chip_shows() -> None:
    async with bench() as b:
        values = [min(255, round(index * 0.99)) for index in range(256)]
        wanted = encode(values)
        held = await b.device.need(MslutTable).write_mslut(wanted)
        assert held.written is True
        assert held.registers == wanted
        await b.device.motion.move(0, 137)
        await b.at_rest()
        held = await b.device.need(MslutTable).read_mslut()
        assert (held.current_a, held.current_b) == decode(wanted).currents(held.position)


async def test_the_dac_offset_beside_the_table_stays() -> None:
    async with bench() as b:
        await b.device.registers.write("START_SIN___START_SIN90_120___DAC_OFFSET", 0, fields={"DAC_OFFSET": 5})
        assert (await b.device.need(MslutTable).write_mslut(POWER_ON)).registers.start >> 24 == 5
