"""Interrupt flags as a timeline: DS-TMC428 8.13, and the position compare of TMC429 and TMC4210."""

from __future__ import annotations

import numpy as np
import pytest

from app.devices.core.capabilities import EventLog
from app.devices.core.results import ChipEvents
from app.emulators.tmc428.options import EmulatorPatch, SwitchChange
from tests.devices.harness import Bench, bench

INTERRUPTS = {
    "tmc428": "interrupt_mask_interrupt_flags",
    "tmc429": "interrupt_mask_interrupt_flags",
    "tmc4210": "INTERRUPT_MASK_INTERRUPT_FLAGS",
}
COMPARES = {
    "tmc429": ("pos_comp_429", "pos_comp_int_429"),
    "tmc4210": ("POS_COMP_4210", "POS_COMP_INT_4210"),
}
MASKS = 0xFF00


def names(b: Bench, axis: int = 0) -> list[str]:
    log = b.device.part(EventLog)
    assert log is not None
    return [name.upper() for entry in log.events(axis).events for name in entry.names]


def entries(b: Bench, axis: int = 0) -> tuple[ChipEvents, ...]:
    log = b.device.part(EventLog)
    assert log is not None
    return log.events(axis).events


async def watch(b: Bench, model: str, axis: int = 0) -> None:
    """All masks on, and what is set already told and forgotten."""
    await b.device.registers.write(INTERRUPTS[model], axis, value=MASKS)
    await b.device.monitor.axis_state(axis)
    await b.device.registers.write(INTERRUPTS[model], axis, value=MASKS | 0xFF)


@pytest.mark.sheet("DS-TMC428", "8.13")
@pytest.mark.parametrize("model", list(INTERRUPTS))
async def test_each_arrival_is_told_anew_and_its_flag_stays_for_its_user(model: str) -> None:
    async with bench(model) as b:
        await watch(b, model)
        seen = len(names(b))
        for target in (300, 600):
            await b.device.motion.move(0, target)
            await b.at_rest()
        assert names(b)[seen:].count("INT_POS_END") == 2
        shown = (await b.device.registers.read(INTERRUPTS[model], 0)).value
        assert shown & 1
        assert shown & 0xFF00 == MASKS
        state = await b.device.monitor.axis_state(0)
        assert {name.upper(): flag for name, flag in state.flags.items()}["INT_POS_END"]
        await b.device.registers.write(INTERRUPTS[model], 0, value=MASKS | 1)
        assert not (await b.device.registers.read(INTERRUPTS[model], 0)).value & 1


@pytest.mark.sheet("DS-TMC428", "8.13")
async def test_without_a_mask_nothing_is_told_and_nothing_written() -> None:
    async with bench("tmc428") as b:
        await b.device.motion.move(0, 300)
        await b.at_rest()
        assert names(b) == []
        assert (await b.device.registers.read(INTERRUPTS["tmc428"], 0)).value == 0


@pytest.mark.sheet("DS-TMC428", "8.13")
async def test_a_mask_that_is_taken_off_takes_its_flag_along() -> None:
    async with bench("tmc428") as b:
        await watch(b, "tmc428")
        await b.device.motion.move(0, 300)
        await b.at_rest()
        await b.device.registers.write(INTERRUPTS["tmc428"], 0, value=0)
        assert (await b.device.registers.read(INTERRUPTS["tmc428"], 0)).value == 0


@pytest.mark.sheet("DS-TMC428", "6.4")
@pytest.mark.sheet("DS-TMC428", "8.13")
async def test_an_event_bears_the_time_of_the_sample_that_showed_int() -> None:
    """A switch is pressed and released on axis 1 while only axis 0 is sampled, every 2 ms."""
    async with bench("tmc428") as b:
        await watch(b, "tmc428", 1)
        seen = len(entries(b, 1))
        plan = b.device.telemetry.sample_plan(["position.0"])
        times: list[float] = []
        rows: list[bytes] = []

        def sink(time_s: float, replies: bytes) -> None:
            times.append(time_s)
            rows.append(replies)

        port = b.device.session.sampling_port
        assert port is not None
        end = port.start_sampling(plan.frames, 0.002, sink)
        began_s = b.clock.now()

        async def run_to(at_s: float) -> None:
            await b.clock.advance(began_s + at_s - b.clock.now())
            port.run_due_samples()
            if times:
                plan.decode(np.array(times), b"".join(rows))
            times.clear()
            rows.clear()
            await b.clock.advance(0.0)

        for press, at_s in ((True, 0.2103), (False, 0.3507), (True, 0.5001)):
            await run_to(at_s)
            b.wire.patch(EmulatorPatch(switches=[SwitchChange(axis=1, left=press)]))
            await run_to(at_s + 0.1)
        end()
        told = entries(b, 1)[seen:]
        lows_and_highs = [(entry.time_s - began_s, name) for entry in told for name in entry.names]
        edges = [(at_s, name) for at_s, name in lows_and_highs if name.startswith("INT_STOP_LEFT")]
        assert [name for _, name in edges] == ["INT_STOP_LEFT_HIGH", "INT_STOP_LEFT_LOW", "INT_STOP_LEFT_HIGH"]
        for (at_s, _), pressed_s in zip(edges, (0.2103, 0.3507, 0.5001), strict=True):
            # sampled by the continuous update every 0.044 s; the flags themselves are read 0.1 s after the edge
            assert 0 <= at_s - pressed_s <= 0.05


@pytest.mark.sheet("DS-TMC4210", "6.2.1.2")
@pytest.mark.parametrize("model", list(COMPARES))
async def test_the_position_compare_is_an_event_of_the_axis_that_is_compared(model: str) -> None:
    async with bench(model) as b:
        position, interrupt = COMPARES[model]
        await b.device.registers.write(position, value=200)
        await b.device.registers.write(interrupt, fields={"M": 1})
        await b.device.monitor.axis_state(0)
        assert "POS_COMP" not in names(b)
        for target in (400, 0):
            await b.device.motion.move(0, target)
            await b.at_rest()
        assert names(b).count("POS_COMP") == 2
        assert (await b.device.registers.read(interrupt)).fields == {"I": 1, "M": 1}
        await b.device.registers.write(interrupt, fields={"I": 1})
        assert (await b.device.registers.read(interrupt)).fields == {"I": 0, "M": 1}


async def test_a_failing_link_loses_no_flag() -> None:
    async with bench("tmc428") as b:
        await watch(b, "tmc428")
        seen = len(names(b))
        await b.device.motion.move(0, 300)
        b.fault(silence=True)
        await b.clock.advance(1.0)
        b.fault(silence=False)
        for _ in range(40):
            await b.clock.advance(0.5)
            if b.device.state == "connected":
                break
        await b.device.monitor.axis_state(0)
        assert names(b)[seen:].count("INT_POS_END") == 1
