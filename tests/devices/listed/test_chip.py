"""The driver of a chip of which only a table is known, over a plain emulated one: what is known is used, no more."""

from __future__ import annotations

import numpy as np
import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.core.config import AxisSettings
from app.devices.core.results import MotionEnd, WriteItem
from app.errors import CannotMove, OutOfRange, SoftLimit, UnknownThing, WriteRefused, WrongState
from app.registers.entry import Model
from app.registers.listed.ramp import ramps_of
from app.registers.model import Field
from tests.devices.listed.chip_harness import BOARD_ONLY, PLAIN, RAMP, bench, made, row

WIRES = {"datagrams": made(), "board": made(**BOARD_ONLY)}


@pytest.fixture(params=WIRES, scope="module")
def model(request: pytest.FixtureRequest) -> Model:
    """With datagrams of 40 bits, and as it is reached by its board alone."""
    return WIRES[request.param]


async def test_registers_and_fields_are_read_and_written(model: Model) -> None:
    async with bench(model) as it:
        registers = it.device.registers
        assert (await registers.write("GCONF", fields={"second": 5})).fields == {"first": 0, "second": 5}
        done = await registers.write("first", value=1)
        assert (done.value, done.verified) == (1, True)
        assert (await registers.read("GCONF")).value == 0x51
        assert {reading.name for reading in await registers.read_all()} == {
            known.name for known in model.table if not known.read_clears
        }
        with pytest.raises(WrongState, match="read only"):
            await registers.write("TOLD", value=1)


async def test_what_reading_may_clear_is_read_only_by_name(model: Model) -> None:
    async with bench(model) as it:
        asked: list[int] = []
        read = it.chip._read
        it.chip._read = lambda address: (asked.append(address), read(address))[1]  # type: ignore[method-assign, func-returns-value]
        written = await it.device.registers.write("GSTAT", value=7)
        assert written.verified is True
        assert "may clear" in written.note
        await it.device.registers.read_all()
        assert "GSTAT.0" not in {channel.name for channel in it.device.telemetry.channels()}
        assert 0x01 not in asked
        assert it.device.registers.clears_when_read("GSTAT")
        assert (await it.device.registers.read("GSTAT")).value == 7
        assert asked.count(0x01) == 1


async def test_a_register_that_does_not_show_what_was_written_keeps_its_other_fields(model: Model) -> None:
    async with bench(model) as it:
        held = it.chip._held
        read = it.chip._read
        it.chip._read = lambda address: 0 if address == 0x10 else read(address)  # type: ignore[method-assign]
        first = await it.device.registers.write("UNSURE", fields={"low": 0x12})
        assert first.verified is None
        assert "not known" in first.note
        await it.device.registers.write("UNSURE", fields={"high": 0x34})
        assert held[0x10] == 0x3412  # over what was written, not over what it reads
        assert [reading.raw for reading in it.device.registers.kept() if reading.name == "UNSURE"] == []
        assert (await it.device.registers.read("UNSURE")).raw == 0


async def test_a_known_register_that_does_not_take_a_value_is_an_error(model: Model) -> None:
    async with bench(model) as it:
        read = it.chip._read
        it.chip._read = lambda address: 0 if address == 0 else read(address)  # type: ignore[method-assign]
        with pytest.raises(WriteRefused):
            await it.device.registers.write("GCONF", value=1)


async def test_moves_rotates_and_stops(model: Model) -> None:
    async with bench(model) as it:
        motion, monitor = it.device.motion, it.device.monitor
        started = await motion.move(0, 4000)
        assert (started.from_position, started.target_position) == (0, 4000)
        assert (await monitor.axis_state(0)).moving
        await it.clock.advance(10.0)
        state = await monitor.axis_state(0)
        assert (state.position, state.position_reached, state.moving, state.mode) == (4000, True, False, "position")
        turning = await motion.rotate(0, -500, "chip")
        assert turning.velocity_chip == -500
        await it.clock.advance(3.0)
        state = await monitor.axis_state(0)
        assert (state.velocity_pps, state.target_velocity_pps) == (-500.0, -500.0)
        (stopped,) = await motion.stop_axes([0], "ramp")
        assert stopped.problem is None
        await it.clock.advance(3.0)
        assert (await monitor.axis_state(0)).velocity_pps == 0
        # The speed of moves is that of before, although rotation and stop have written over it.
        await motion.move(0, 0)
        assert (await it.device.registers.read("VMAX", 0)).value == 2000
        await it.clock.advance(10.0)
        ends = [event.reason for event in it.told if isinstance(event, MotionEnd)]
        assert ends == ["target_reached", "stop_command", "target_reached"]


async def test_an_immediate_stop_brakes_harder_and_leaves_the_users_acceleration(model: Model) -> None:
    async with bench(model) as it:
        await it.device.registers.write("AMAX", 0, 100)
        await it.device.motion.rotate(0, 1000, "chip")
        await it.clock.advance(20.0)
        (stopped,) = await it.device.motion.stop_axes([0], "immediate")
        assert stopped.problem is None
        await it.clock.advance(0.1)
        assert (await it.device.monitor.axis_state(0)).velocity_pps == 0
        await it.device.motion.move(0, 0)
        assert (await it.device.registers.read("AMAX", 0)).value == 100


async def test_what_cannot_move_says_why(model: Model) -> None:
    async with bench(model) as it:
        await it.device.registers.write("VMAX", 0, 0)
        with pytest.raises(CannotMove, match="VMAX is 0"):
            await it.device.motion.move(0, 100)
        with pytest.raises(OutOfRange):
            await it.device.motion.rotate(0, 1 << 23)
        with pytest.raises(OutOfRange):
            await it.device.motion.move(0, 1 << 31)


async def test_soft_limits_hold_by_name_and_by_frame(model: Model) -> None:
    limits = AxisLimits(position_min=-1000, position_max=1000, velocity_max_pps=3000)
    async with bench(model, AxisSettings(name="limited", limits=limits)) as it:
        with pytest.raises(SoftLimit):
            await it.device.motion.move(0, 1001)
        with pytest.raises(SoftLimit):
            await it.device.motion.rotate(0, 3001, "chip")
        with pytest.raises(SoftLimit):
            await it.device.registers.write("XTARGET", 0, 2000)
        frame = bytes((0xAD, 0, 0, 0x10, 0)) if model.datagram_bits else board_write(0x2D, 4096)
        with pytest.raises(SoftLimit):
            await it.device.raw.exchange(frame)
        with pytest.raises(SoftLimit):
            await it.device.registers.write_many([WriteItem("VMAX", 0, 5000), WriteItem("GCONF", None, 1)])
        await it.device.motion.rotate(0, 400, "chip")
        for _ in range(100):
            await it.clock.advance(0.1)
        state = await it.device.monitor.axis_state(0)
        assert state.velocity_pps == 0
        assert 900 < state.position <= 1000


def board_write(address: int, value: int) -> bytes:
    body = bytes((1, 147, address, 0)) + value.to_bytes(4, "big")
    return body + bytes((sum(body) & 0xFF,))


async def test_registers_and_fields_are_channels(model: Model) -> None:
    async with bench(model) as it:
        await it.device.registers.write("GCONF", value=0x71)
        await it.device.motion.rotate(0, -100, "chip")
        await it.clock.advance(2.0)
        plan = it.device.telemetry.sample_plan(["velocity.0", "GCONF.second.0", "GCONF.0", "VACTUAL.0"])
        taken = await it.device.telemetry.take_samples(plan)
        columns = plan.decode(np.asarray(taken.times_s), taken.replies[0])
        assert columns.tolist() == [[-100.0, 7.0, 0x71, -100.0]]


async def test_a_chip_without_a_ramp_generator_has_no_axes(model: Model) -> None:
    bare = made(PLAIN, **(BOARD_ONLY if model.datagram_bits == 0 else {}))
    assert (bare.axes, bare.can("motion"), bare.can("registers")) == (0, False, True)
    async with bench(bare) as it:
        assert it.device.axes == ()
        for refused in (it.device.motion.move(0, 1), it.device.monitor.axis_state(0), it.device.motion.rotate(0, 1)):
            with pytest.raises(UnknownThing):
                await refused
        assert await it.device.motion.stop_axes([], "ramp") == []
        await it.device.registers.write("GCONF", value=0x71)
        plan = it.device.telemetry.sample_plan(["GCONF.0", "UNSURE.low.0"])
        taken = await it.device.telemetry.take_samples(plan)
        assert plan.decode(np.asarray(taken.times_s), taken.replies[0]).tolist() == [[0x71, 0.0]]
        assert any("no axis" in told for told in it.device.identity.shortcomings)


async def test_raw_frames_are_decoded(model: Model) -> None:
    async with bench(model) as it:
        if model.datagram_bits:
            await it.device.raw.exchange(bytes((0x80, 0, 0, 0, 0x51)))
            told = (await it.device.raw.exchange(bytes(5))).decoded
        else:
            await it.device.raw.exchange(board_write(0, 0x51))
            body = bytes((1, 149, 0, 0, 0, 0, 0, 0))
            told = (await it.device.raw.exchange(body + bytes((sum(body) & 0xFF,)))).decoded
        assert (told["register"], told["fields"]) == ("GCONF", {"first": 1, "second": 5})


def test_names_that_mean_something_else_make_no_ramp_generator() -> None:
    assert len(ramps_of(RAMP)) == 1
    wide = [row("RAMPMODE", 0x20, 3) if known.name == "RAMPMODE" else known for known in RAMP]
    assert ramps_of(wide) == ()  # a mode of another width is another mode
    assert ramps_of([known for known in RAMP if known.name != "AMAX"]) == ()
    assert ramps_of([*RAMP, row("OTHER_VMAX", 0x30)]) == ()  # two of one role


def test_axes_are_told_by_the_names() -> None:
    for names in (("{}_M1", "{}_M2"), ("M0_{}", "M1_{}")):
        rows = [
            row(name.format(known.name), known.address + 0x20 * axis, known.width)
            for axis, name in enumerate(names)
            for known in RAMP
        ]
        assert [ramp.axis for ramp in ramps_of(rows)] == [0, 1]


async def test_one_mode_register_for_two_axes() -> None:
    shared = row(
        "RAMPMODE",
        0x07,
        fields=(Field("RAMPMODE_M0_RAMPMODE", 2, ""), Field("RAMPMODE_M1_RAMPMODE", 2, "", lsb=2)),
    )
    rest = [
        row(f"M{axis}_{known.name}", known.address + 0x20 * axis, known.width)
        for axis in (0, 1)
        for known in RAMP
        if known.name != "RAMPMODE"
    ]
    async with bench(made([shared, *rest])) as it:
        await it.device.motion.rotate(0, 300, "chip")
        await it.device.motion.rotate(1, -200, "chip")
        await it.clock.advance(5.0)
        speeds = [(await it.device.monitor.axis_state(axis)).velocity_pps for axis in (0, 1)]
        assert speeds == [300.0, -200.0]
        (stopped,) = await it.device.motion.stop_axes([1], "ramp")
        assert stopped.problem is None
        await it.clock.advance(5.0)
        speeds = [(await it.device.monitor.axis_state(axis)).velocity_pps for axis in (0, 1)]
        assert speeds == [300.0, 0.0]


async def test_a_lost_answer_and_an_unplugged_chip_are_told(model: Model) -> None:
    async with bench(model) as it:
        await it.device.motion.rotate(0, 300, "chip")
        it.patch(faults={"unplugged": True})
        (stopped,) = await it.device.motion.stop_axes([0], "ramp")
        assert stopped.problem is not None
        assert it.device.state == "failed"
        it.patch(faults={"unplugged": False})
        (stopped,) = await it.device.motion.stop_axes([0], "ramp")
        assert stopped.problem is None
