"""Into a device as one transaction: back to where it was, or told exactly what is left."""

from __future__ import annotations

import asyncio
import random
from collections.abc import Callable, Sequence
from contextvars import Context
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from app.devices.core.axis_limits import AxisLimits
from app.devices.core.config import AxisSettings
from app.devices.core.device import Device
from app.devices.manager import DeviceChange
from app.devices.tmc5xxx.memory import ChipMemory as SixPointMemory
from app.devices.tmc4361.memory import ChipMemory
from app.errors import SoftLimit, WrongState
from app.profiles.apply import Transaction
from app.profiles.capture import capture
from app.profiles.diff import compare, diff
from app.profiles.document import ProfileDocument, parse
from app.profiles.errors import ProfileMisfit, ProfileTakenBack, UnreadableProfile
from app.profiles.service import ProfileService
from app.registers.tmcl.modules import MODULES
from tests.profiles.faults import FAULTS, Fault, Injector, target_of, try_fault
from tests.profiles.harness import EVERY_MODEL, FAMILIES, Bench, bench, by_place, change


@pytest.mark.parametrize("model", EVERY_MODEL)
@settings(max_examples=3, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0.05, 1.0))
@example(seed=8842643, share=0.75)  # starts of a TMC4361 move its pipeline into GENERAL_CONF meanwhile
async def test_what_was_captured_comes_back_whatever_was_changed_since(model: str, seed: int, share: float) -> None:
    async with bench(model) as b:
        first, truth = await capture(b.device, unix_s=1.0), b.truth()
        await change(b.device, random.Random(seed), share if model not in MODULES else share / 4)
        changed = b.truth()
        applied = await Transaction(b.device, first).run()
        assert await capture(b.device, unix_s=1.0) == first
        assert by_place(b.truth(), model) == by_place(truth, model)
        assert len(applied.written) >= sum(truth[key] != changed[key] for key in truth)
        assert (await diff(b.device, first)).differences == []


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("model", FAMILIES)
async def test_after_a_fault_all_is_as_before_or_what_is_left_is_told(model: str, fault: Fault) -> None:
    """Two steps of each; `tests.bench.profile_faults` does all of them."""
    document = await target_of(model, seed=5, share=0.1 if model != "tmc4210" else 0.7)
    first = await try_fault(document, fault, 0)
    assert first is not None
    assert first.outcome != "wrong", first.detail
    later = await try_fault(document, fault, first.of // 2, frame=1, seed=3)
    assert later is None or later.outcome != "wrong", later.detail


async def test_an_apply_that_was_taken_back_says_what_failed_and_why() -> None:
    document = await target_of("tmc5160", seed=5, share=0.5)
    async with bench("tmc5160") as b:
        injector = Injector(b, "refused write", 0)
        steps = len((await diff(b.device, document)).differences)
        readable = next(
            index
            for index, difference in enumerate((await diff(b.device, document)).differences)
            if difference.name == "CHOPCONF"
        )
        injector.at = readable
        with pytest.raises(ProfileTakenBack) as told:
            await Transaction(b.device, document, journal=injector).run()
        assert (told.value.failed["name"], told.value.written, told.value.of) == ("CHOPCONF", readable, steps)
        assert told.value.left == []
        assert "all is as it was before" in str(told.value)


# --- the motor stands, and goes on standing ---------------------------------------------------------


def ramp_of(model: str, fast: int) -> dict[str, Any]:
    """A profile of some speed and acceleration."""
    names = {"tmc428": ("v_max", "a_max"), "tmc4210": ("V_MAX", "A_MAX")}.get(model, ("VMAX", "AMAX"))
    if model == "tmc4361":
        fast *= 256
    registers = [{"name": name, "axis": 0, "value": fast} for name in names]
    return {"format": "stepscope-profile", "version": 1, "model": model, "clock_hz": 16e6, "registers": registers}


def module_ramp(fast: int) -> dict[str, Any]:
    parameters = [{"name": name, "value": fast} for name in ("maximum_positioning_speed", "maximum_acceleration")]
    return {**ramp_of("pd42-1241", fast), "registers": [], "parameters": parameters}


async def stopped_on_the_way(b: Bench) -> int:
    """Where the axis stands after a stop in the middle of a move."""
    await b.device.motion.move(0, 60_000)
    await b.clock.advance(0.3)
    await b.device.stop(0)
    await b.clock.advance(2.0)
    state = await b.device.monitor.axis_state(0)
    assert not state.moving
    assert 0 < state.position < 60_000
    return state.position


@pytest.mark.parametrize("model", FAMILIES)
async def test_nothing_moves_where_a_stop_has_left_a_target_behind(model: str) -> None:
    async with bench(model) as b:
        position = await stopped_on_the_way(b)
        document = parse(module_ramp(12_345) if model in MODULES else ramp_of(model, 1234))
        await Transaction(b.device, document).run()
        await b.clock.advance(5.0)
        state = await b.device.monitor.axis_state(0)
        assert (state.position, state.moving) == (position, False)
        assert (await diff(b.device, document)).differences == []
        await b.device.motion.move(0, position + 500)  # and it goes where it is told to
        await b.clock.advance(20.0)
        assert (await b.device.monitor.axis_state(0)).position == position + 500


@pytest.mark.parametrize("model", ["tmc428", "tmc5160", "tmc4361"])
async def test_a_stop_does_not_show_in_a_profile(model: str) -> None:
    """What a stop writes over VMAX and the mode comes back with the next move: it is no configuration."""
    async with bench(model) as b:
        before = await capture(b.device, unix_s=1.0)
        await stopped_on_the_way(b)
        compared = compare(before, await capture(b.device, unix_s=1.0))
        assert [each.name for each in compared.differences if each.right is not None] == []
        unreadable = b.device.part(ChipMemory) or b.device.part(SixPointMemory)
        assert unreadable or [each.name for each in compared.differences] == []


async def test_an_axis_that_moves_or_would_is_refused() -> None:
    async with bench("tmc428") as b:
        document = parse(ramp_of("tmc428", 900))
        await b.device.motion.rotate(0, 1000.0)
        await b.clock.advance(0.5)
        with pytest.raises(WrongState, match="axis 0 of Bench moves"):
            await Transaction(b.device, document).run()
        assert (await b.device.registers.read("v_max", 0)).value == 1500


async def test_a_stop_in_the_middle_ends_it_and_takes_it_back() -> None:
    document = await target_of("tmc428", seed=2, share=0.3)
    async with bench("tmc428") as b:
        before = b.truth()

        class Stopping(Injector):
            async def begin(self, steps: Any, program: Any = None) -> None:
                self.steps = steps

            def reached(self, index: int) -> None:
                if index == self.at:
                    Context().run(b.device.session.commanded, 0, "stop")  # as one of another client is heard of

        with pytest.raises(ProfileTakenBack, match="commanded by another client"):
            await Transaction(b.device, document, journal=Stopping(b, "silent", 4)).run()
        assert by_place(b.truth(), "tmc428") == by_place(before, "tmc428")


# --- what is refused before anything is written -----------------------------------------------------


async def test_another_chip_of_the_family_is_refused_with_what_it_lacks() -> None:
    async with bench("tmc5160") as one, bench("tmc5130") as other:
        document = await capture(one.device)
        with pytest.raises(ProfileMisfit, match=r"TMC5160.*TMC5130.*lacks DRV_CONF"):
            await Transaction(other.device, document).run()


async def test_some_fields_of_a_register_that_nobody_knows_are_refused() -> None:
    async with bench("tmc4361", started=False) as b:
        await b.device.monitor.axis_state(0)
        memory = b.device.part(ChipMemory)
        assert memory is not None
        memory.forget_reset()  # as behind a server that was started after the chip
        part = {"name": "ENC_VMEAN", "axis": 0, "fields": {"ENC_VMEAN_WAIT": 3}}
        document = parse({**ramp_of("tmc4361", 1), "registers": [part]})
        found = await diff(b.device, document)
        assert (found.differences[0].left, "cannot be read" in found.differences[0].why) == (None, True)
        with pytest.raises(ProfileMisfit, match="all of its fields"):
            await Transaction(b.device, document).run()


async def test_a_number_that_may_not_be_written_ends_it_before_the_first() -> None:
    async with bench("tmc428") as b:
        registers = [
            {"name": "v_min", "axis": 0, "value": 7},
            {"name": "pmul_pdiv", "axis": 0, "fields": {"pdiv": 15}},
        ]
        document = parse({**ramp_of("tmc428", 1), "registers": registers})
        before = b.truth()
        with pytest.raises(UnreadableProfile, match="pdiv"):
            await Transaction(b.device, document).run()
        assert b.truth() == before


async def test_start_signals_do_not_keep_writes_away() -> None:
    """START_CONF makes VMAX wait: it is opened for the writes, and is as the profile says in the end."""
    async with bench("tmc4361") as b:
        gated = await capture(b.device, unix_s=1.0)
        await b.device.registers.write("START_CONF", 0, fields={"start_en[1]": 1})
        with_gate = await capture(b.device, unix_s=1.0)
        document = parse(ramp_of("tmc4361", 5120))
        await Transaction(b.device, document).run()
        assert (await b.device.registers.read("VMAX", 0)).value == 5120 * 256
        assert (await b.device.registers.read("START_CONF", 0)).fields["start_en[1]"] == 1
        await Transaction(b.device, with_gate).run()
        assert await capture(b.device, unix_s=1.0) == with_gate
        await Transaction(b.device, gated).run()
        assert await capture(b.device, unix_s=1.0) == gated


def test_an_empty_profile_fits_everywhere_and_says_nothing() -> None:
    empty = ProfileDocument(model="tmc428", clock_hz=16e6)
    assert compare(empty, empty).differences == []


async def test_soft_limits_are_looked_at_before_the_first_write() -> None:
    async with bench("tmc428") as b:
        settings_ = [axis.settings for axis in b.device.axes]
        settings_[0] = replace(settings_[0], limits=AxisLimits(velocity_max_pps=25_000.0))
        await b.manager.edit(b.device.id, DeviceChange(axes=tuple(settings_)))
        registers = [{"name": "v_min", "axis": 0, "value": 7}, {"name": "v_max", "axis": 0, "value": 2047}]
        before = b.truth()
        with pytest.raises(SoftLimit):
            await Transaction(b.device, parse({**ramp_of("tmc428", 1), "registers": registers})).run()
        assert b.truth() == before


async def test_soft_limits_that_are_set_meanwhile_stay(tmp_path: Path) -> None:
    """The first run's page sets them while the start-up of before is still written."""
    async with bench("tmc5160") as b:
        document = await capture(b.device, unix_s=1.0)
        document.axes[0].full_steps_per_rev = 400
        await change(b.device, random.Random(1), 0.5)
        limited = replace(b.device.axes[0].settings, limits=AxisLimits(velocity_max_pps=25_000.0))
        edits: list[asyncio.Task[Device]] = []

        def limit_it(frame: bytes, answer: Callable[[bytes], bytes]) -> bytes:
            if not edits:
                edits.append(asyncio.ensure_future(b.manager.edit(b.device.id, DeviceChange(axes=(limited,)))))
            return answer(frame)

        async def configure(device: Device, axes: Sequence[AxisSettings]) -> None:
            assert edits[0].done(), "the limits were set before the end"
            await b.manager.edit(device.id, DeviceChange(axes=tuple(axes)))

        b.wire.spoil = limit_it
        await ProfileService(tmp_path, lambda _: "", configure).apply(b.device, document)
        assert b.device.axes[0].settings == replace(limited, full_steps_per_rev=400)
