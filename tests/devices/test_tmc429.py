"""The driver of a TMC429: a chain of SPI drivers as with a TMC428, or step/direction where the chip is told to."""

from __future__ import annotations

import pytest

from app.devices.core.start_up import Figures
from app.devices.tmc428.start_up import AxisStart, start_up
from app.emulators.tmc428.options import EmulatorPatch
from app.errors import UsageError
from app.profiles.start_up import StartUpRequest, dry_run

from .harness import START, Bench, bench

STARTED = AxisStart(START.v_max, START.a_max, START.pulse_div, START.ramp_div, stops=False)


async def interface(made: Bench, **fields: int) -> None:
    await made.device.registers.write("if_configuration_429", fields=dict(fields))


async def stepping(made: Bench) -> None:
    """Set up for step/direction drivers."""
    await interface(made, en_sd=1)
    await start_up(made.device, [STARTED] * 3)


async def test_by_its_start_up_it_drives_the_chain() -> None:
    async with bench("tmc429") as b:
        await b.device.motion.move(1, 640)
        await b.at_rest(1)
        state = b.wire.state()
        assert state.axes[1].position_fullsteps - 3750 == pytest.approx(10)
        assert state.driver_chain is not None
        assert state.driver_chain.datagrams_sent > 0
        assert [axis.microsteps_per_full_step for axis in b.device.axes] == [64] * 3


async def test_told_to_give_steps_it_is_set_up_without_a_chain() -> None:
    async with bench("tmc429", started=False, driver_microsteps=16) as b:
        await stepping(b)
        await b.device.identity.refresh()
        assert [axis.microsteps_per_full_step for axis in b.device.axes] == [16] * 3
        await b.device.motion.move(2, 640)
        await b.at_rest(2)
        state = b.wire.state()
        assert state.axes[2].position_fullsteps - 3750 == pytest.approx(40)
        assert [one.steps_sent for one in state.step_dirs] == [0, 0, 640]
        tried = await dry_run(b.device, StartUpRequest())
        written = {difference.name for difference in tried.diff.differences}
        assert "usrs" not in written
        assert not any(name.startswith(("chain_conf", "lut_", "is_")) for name in written)
        with pytest.raises(UsageError, match="step/direction driver"):
            await dry_run(b.device, StartUpRequest(figures=Figures(microsteps=64)))


async def test_where_the_compare_register_is_the_chip_says() -> None:
    async with bench("tmc429") as b:
        counter = b.device.counter
        assert [counter.compare_register(axis) for axis in range(3)] == ["pos_comp_429", None, None]
        await interface(b, pos_comp_sel=2)
        assert [counter.compare_register(axis) for axis in range(3)] == [None, None, "pos_comp_429"]


async def test_right_switches_are_there_once_their_pins_are_switched_on() -> None:
    async with bench("tmc429", started=False) as b:
        assert (await b.device.monitor.axis_state(1)).switches.right is None
        await interface(b, en_refr=1)
        b.wire.patch(EmulatorPatch.model_validate({"switches": [{"axis": 1, "right": True}]}))
        state = await b.device.monitor.axis_state(1)
        assert (state.switches.left, state.switches.right) == (False, True)


async def test_a_figure_that_it_cannot_have_is_named() -> None:
    async with bench("tmc429", started=False) as b:
        with pytest.raises(UsageError, match="a TMC429 reads no encoder"):
            await dry_run(b.device, StartUpRequest(figures=Figures(counts_per_rev=4000)))
