"""Microstep table, driver chain, profile, and the way to a running motor."""

from __future__ import annotations

import asyncio

import pytest

from app.calc.driver_chain.chain import build_chain
from app.calc.microsteps.table import design_table
from app.devices.core.capabilities import DriverChainRam, MicrostepRam
from app.devices.tmc428.start_up import AxisStart, start_up
from app.errors import OutOfRange, UsageError, WriteRefused, WrongState
from app.registers.catalog import CHIPS_32
from tests.devices.harness import bench


@pytest.mark.sheet("DS-TMC428", "7.3")
async def test_the_ram_is_noise_until_it_is_written() -> None:
    async with bench(started=False) as b:
        noise = await b.device.need(MicrostepRam).read_microstep_table()
        assert len(set(noise)) > 10
        wanted = list(design_table(sigma=-0.3).values)
        assert await b.device.need(MicrostepRam).write_microstep_table(wanted) == wanted
        assert await b.device.need(MicrostepRam).read_microstep_table() == wanted


@pytest.mark.parametrize("values", [[0] * 63, [0] * 65, [64] + [0] * 63, [-1] + [0] * 63, []])
async def test_what_is_no_table_is_not_written(values: list[int]) -> None:
    async with bench() as b:
        before = await b.device.need(MicrostepRam).read_microstep_table()
        with pytest.raises(UsageError):
            await b.device.need(MicrostepRam).write_microstep_table(values)
        assert await b.device.need(MicrostepRam).read_microstep_table() == before


@pytest.mark.sheet("DS-TMC428", "11.2")
async def test_a_driver_chain_there_and_back() -> None:
    async with bench(started=False) as b:
        chain = build_chain(["tmc236", {"driver": "tmc249", "fast_decay": True}])
        held = await b.device.need(DriverChainRam).write_driver_chain(chain.ram_words, chain.lsmd)
        assert (held.ram_words, held.lsmd) == (list(chain.ram_words), 1)
        assert (await b.device.registers.read("LSMD")).value == 1
        assert (await b.device.registers.read("clk2_div")).value == 15  # the rest of the register is as it was


async def test_what_is_no_chain_is_not_written() -> None:
    async with bench() as b:
        for words, lsmd in (([0x40], 0), ([0] * 33, 0), ([], 0), ([0], 3)):
            with pytest.raises(OutOfRange):
                await b.device.need(DriverChainRam).write_driver_chain(words, lsmd)


async def test_a_table_that_does_not_arrive_is_reported() -> None:
    async with bench() as b:
        b.fault(errors=0.2)
        with pytest.raises(WriteRefused):
            await b.device.need(MicrostepRam).write_microstep_table([0] * 64)


async def test_two_tables_at_once_do_not_mix() -> None:
    async with bench() as b:
        await asyncio.gather(*(b.device.need(MicrostepRam).write_microstep_table([value] * 64) for value in (3, 60)))
        assert len(set(await b.device.need(MicrostepRam).read_microstep_table())) == 1


async def test_a_table_is_sent_while_the_motor_runs() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 5000)
        await b.clock.advance(0.5)
        await b.device.need(MicrostepRam).write_microstep_table(list(design_table(sigma=0.5).values))
        assert (await b.device.monitor.axis_state(0)).velocity_pps > 4900


async def test_a_tmc4210_has_neither() -> None:
    async with bench("tmc4210") as b:
        with pytest.raises(WrongState, match="no microstep table"):
            await b.device.need(MicrostepRam).read_microstep_table()
        with pytest.raises(WrongState, match="no microstep table"):
            await b.device.need(MicrostepRam).write_microstep_table([0] * 64)
        with pytest.raises(WrongState, match="no chain"):
            await b.device.need(DriverChainRam).read_driver_chain()
        with pytest.raises(WrongState, match="no chain"):
            await b.device.need(DriverChainRam).write_driver_chain([0], 0)


@pytest.mark.sheet("DS-TMC428", "13")
@pytest.mark.parametrize("model", list(CHIPS_32))
async def test_after_the_start_up_the_motor_runs(model: str) -> None:
    async with bench(model) as b:
        chain = b.wire.state().driver_chain
        assert (chain is None) == (model == "tmc4210")
        await b.device.motion.move(0, 640)
        await b.at_rest()
        moved = b.wire.state().axes[0].position_fullsteps - 3750.0
        assert moved == pytest.approx(640 / (16 if model == "tmc4210" else 64))


async def test_a_start_without_a_pair_is_refused() -> None:
    async with bench(started=False) as b:
        with pytest.raises(UsageError, match="no pmul and pdiv"):
            await start_up(b.device, [AxisStart(v_max=100, a_max=1, pulse_div=0, ramp_div=13)])
