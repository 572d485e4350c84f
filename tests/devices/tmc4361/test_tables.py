"""The microstep table, and the configuration as a document, of registers that cannot be read."""

from __future__ import annotations

from app.calc.mslut import POWER_ON, decode, encode
from app.devices.device import Device
from tests.devices.tmc4361.bench import bench


async def test_the_table_is_the_one_of_power_on_until_it_is_written() -> None:
    async with bench() as b:
        held = await b.device.read_mslut()
        assert held.registers == POWER_ON
        assert held.written is False


async def test_what_is_written_is_what_the_chip_shows() -> None:
    async with bench() as b:
        values = [min(255, round(index * 0.99)) for index in range(256)]
        wanted = encode(values)
        held = await b.device.write_mslut(wanted)
        assert held.written is True
        assert held.registers == wanted
        await b.device.move(0, 137)
        await b.at_rest()
        held = await b.device.read_mslut()
        assert (held.current_a, held.current_b) == decode(wanted).currents(held.position)


async def test_the_dac_offset_beside_the_table_stays() -> None:
    async with bench() as b:
        await b.device.write("START_SIN___START_SIN90_120___DAC_OFFSET", 0, fields={"DAC_OFFSET": 5})
        assert (await b.device.write_mslut(POWER_ON)).registers.start >> 24 == 5


async def test_a_profile_makes_another_chip_behave_like_this_one() -> None:
    async with bench() as one, bench(None) as other:
        await one.device.write("PID_P", 0, 4321)
        document = await one.device.profile()
        entries = {entry.name: entry for entry in document.registers}
        assert entries["PID_P"].value == 4321
        assert entries["ENC_IN_RES"].fields["ENC_IN_RES"] == 40_000
        assert not {"XACTUAL", "XTARGET", "ENC_POS", "EVENTS", "X_PIPE0"} & entries.keys()
        for entry in document.registers:
            await _put(other.device, entry.name, entry.raw)
        again = {entry.name: entry.raw for entry in (await other.device.profile()).registers}
        assert again == {name: entry.raw for name, entry in entries.items()}


async def _put(device: Device, name: str, raw: int) -> None:
    from app.registers.tmc4361 import TMC4361

    await device.write(name, 0, TMC4361.get(name, 0).decode(raw))
