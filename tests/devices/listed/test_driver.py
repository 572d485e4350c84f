"""What the driver of a listed module does beside the plain way: lost answers, missing parameters, limits, strangers."""

from __future__ import annotations

import numpy as np
import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.core.capabilities import TmclCommands
from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.events import DeviceEvent, MotionCommanded
from app.devices.core.results import MotionEnd, WriteItem
from app.errors import (
    CannotMove,
    LinkTimeout,
    OtherModel,
    OutOfRange,
    SoftLimit,
    UnknownParameter,
    UnknownThing,
    UsageError,
    WrongState,
)
from app.links.tmcl import Request
from app.registers import catalog
from app.registers.tmcl.commands import Opcode
from tests.devices.listed.harness import NAMES, SEVERAL, Bench, bench


async def test_a_parameter_that_the_firmware_lacks_is_left_out_and_the_rest_works() -> None:
    async with bench(unknown_parameters=[6]) as made:
        lacking = made.device.family.table.find("ap6", 0)
        assert lacking is not None
        with pytest.raises(UnknownParameter):
            await made.device.registers.write(lacking[0].name, 0, 3)
        read = await made.device.registers.read_all()
        assert lacking[0].name not in {reading.name for reading in read}
        assert len(read) > 50
        assert any(lacking[0].name in told for told in made.device.identity.shortcomings)


async def test_what_reading_may_clear_is_read_only_by_name() -> None:
    async with bench() as made:
        flags = next(row for row in made.device.family.table if row.read_clears)
        assert flags.name not in {reading.name for reading in await made.device.registers.read_all()}
        assert not any(channel.quantity == flags.name for channel in made.device.telemetry.channels())
        assert made.device.registers.clears_when_read(flags.name, 0)
        written = await made.device.registers.write(flags.name, 0, 5)
        assert written.verified is None
        assert (await made.device.registers.read(flags.name, 0)).value == 5


async def test_a_lost_answer_of_a_move_is_told_and_nothing_is_sent_twice() -> None:
    async with bench() as made:
        seen: list[int] = []
        heard = made.module.receive

        def receive(frame: bytes, at_s: float | None = None) -> bytes | None:
            seen.append(frame[1])
            if frame[1] == Opcode.MVP:
                heard(frame, at_s)
                return None
            return heard(frame, at_s)

        made.module.receive = receive  # type: ignore[method-assign]
        with pytest.raises(LinkTimeout, match="may or may not have been done"):
            await made.device.motion.move(0, 3000)
        assert seen.count(Opcode.MVP) == 1
        for _ in range(100):
            await made.clock.advance(0.1)
        assert [end.reason for end in made.device.monitor.motion_ends(0)][-1] in ("unknown", "lost_link")


async def test_a_write_whose_answer_is_lost_is_proven_by_reading_back() -> None:
    async with bench() as made:
        heard = made.module.receive

        def receive(frame: bytes, at_s: float | None = None) -> bytes | None:
            reply = heard(frame, at_s)
            return None if frame[1] == Opcode.SAP else reply

        made.module.receive = receive  # type: ignore[method-assign]
        assert (await made.device.registers.write(made.row("max_speed").name, 0, 777)).verified


async def test_writing_a_target_moves_and_is_told_before() -> None:
    async with bench() as made:
        told: list[DeviceEvent] = []
        made.device.listen(told.append)
        await made.device.registers.write(made.row("target_position").name, 0, 500)
        assert [event.axis for event in told if isinstance(event, MotionCommanded)] == [0]
        for _ in range(50):
            await made.clock.advance(0.1)
        ends = [event for event in told if isinstance(event, MotionEnd)]
        assert [(end.reason, end.position) for end in ends] == [("target_reached", 500)]


@pytest.mark.parametrize("role", ["max_speed", "max_acceleration"])
async def test_nothing_is_sent_off_that_would_not_move(role: str) -> None:
    async with bench() as made:
        await made.device.registers.write(made.row(role).name, 0, 0)  # type: ignore[arg-type]
        with pytest.raises(CannotMove, match="is 0"):
            await made.device.motion.move(0, 100)


async def test_units_that_nobody_knows_are_refused_or_warned_of() -> None:
    async with bench() as made:
        assert (await made.device.motion.rotate(0, 100)).warnings
        with pytest.raises(UsageError, match="no unit"):
            await made.device.motion.rotate(0, 1, "rps")
        with pytest.raises(OutOfRange):
            await made.device.motion.rotate(0, 1e12, "chip")
        with pytest.raises(OutOfRange):
            await made.device.motion.move(0, 1 << 31)


def with_global(alias: str) -> str:
    """A module that lists a global parameter."""
    return next(name for name in NAMES if any(row.alias == alias for row in catalog.find_model(name).table))


async def test_suppressed_answers_are_refused_and_another_address_is_told() -> None:
    async with bench(with_global("gp0_255")) as made:
        table = made.device.family.table
        suppress = next(row for row in table if row.alias == "gp0_255")
        with pytest.raises(WrongState, match="without answers"):
            await made.device.registers.write(suppress.name, None, 1)
        address = next(row for row in table if row.alias == "gp0_66")
        written = await made.device.registers.write(address.name, None, 9)
        assert written.verified is None  # a plain emulator keeps its address
        assert written.note


async def limited(made: Bench) -> None:
    for target in (5001, -1):
        with pytest.raises(SoftLimit):
            await made.device.motion.move(0, target)
        with pytest.raises(SoftLimit):
            await made.device.need(TmclCommands).tmcl("MVP", "ABS", 0, target)
        with pytest.raises(SoftLimit):
            await made.device.registers.write(made.row("target_position").name, 0, target)


async def test_soft_limits_hold_on_every_way() -> None:
    limits = AxisLimits(position_min=0, position_max=5000, velocity_max_pps=3000, acceleration_max_pps2=4000)
    async with bench(NAMES[0], AxisSettings(limits=limits)) as made:
        await limited(made)
        registers, console = made.device.registers, made.device.need(TmclCommands)
        with pytest.raises(SoftLimit):
            await made.device.motion.rotate(0, 3001, "chip")
        for command in ("ROR", "ROL"):
            with pytest.raises(SoftLimit):
                await console.tmcl(command, 0, 0, 3001)
        for role in ("max_speed", "target_speed"):
            with pytest.raises(SoftLimit):
                await registers.write(made.row(role).name, 0, 3001)
        with pytest.raises(SoftLimit):
            await registers.write_many([WriteItem(made.row("max_acceleration").name, 0, 4001)])
        for command, type_ in (("MVP", "REL"), ("RSAP", 4), ("RFS", "START")):
            with pytest.raises(WrongState, match="soft limits"):
                await console.tmcl(command, type_, 0, 1)
        frame = Request(1, Opcode.MVP, 0, 0, 5001).encode()
        with pytest.raises(SoftLimit):
            await made.device.raw.exchange(frame)
        await made.device.motion.move(0, 5000)
        for _ in range(80):
            await made.clock.advance(0.1)
        assert (await made.device.monitor.axis_state(0)).position == 5000


async def test_a_rotation_ends_at_the_end_of_its_range() -> None:
    limits = AxisLimits(position_min=-5000, position_max=5000)
    async with bench(NAMES[0], AxisSettings(limits=limits)) as made:
        await made.device.motion.rotate(0, 1500, "chip")
        for _ in range(200):
            await made.clock.advance(0.05)
        state = await made.device.monitor.axis_state(0)
        assert not state.moving
        assert 3000 < state.position <= 5000


async def test_limits_of_one_axis_are_not_those_of_another() -> None:
    free = AxisSettings(name="free")
    limits = AxisSettings(limits=AxisLimits(position_min=0, position_max=5000))
    async with bench(SEVERAL, limits, free) as made:
        await limited(made)
        await made.device.motion.move(1, 9000)
        await made.device.need(TmclCommands).tmcl("MVP", "REL", 1, -20_000)


async def test_axes_move_together_and_a_stop_of_one_leaves_the_other() -> None:
    async with bench(SEVERAL) as made:
        await made.device.motion.rotate(0, 300, "chip")
        await made.device.motion.rotate(1, -400, "chip")
        await made.clock.advance(1.0)
        assert (await made.device.stop(0)).ok
        await made.clock.advance(1.0)
        states = [await made.device.monitor.axis_state(axis) for axis in (0, 1)]
        assert [state.velocity_pps for state in states] == [0, -400]


async def test_samples_tell_of_the_end_of_a_motion() -> None:
    async with bench() as made:
        plan = made.device.telemetry.sample_plan(["position.0", "velocity.0"])
        await made.device.motion.move(0, 2000)
        positions = []
        for _ in range(60):
            made.clock.set(made.clock.now() + 0.1)
            taken = await made.device.telemetry.take_samples(plan)
            positions.append(plan.decode(np.array(taken.times_s), taken.replies[0])[0, 0])
        assert positions == sorted(positions)
        assert positions[-1] == 2000
        assert [end.reason for end in made.device.monitor.motion_ends(0)] == ["target_reached"]
        with pytest.raises(UnknownThing):
            made.device.telemetry.sample_plan(["nothing.0"])


async def test_another_module_is_known_by_what_it_calls_itself() -> None:
    async with bench(NAMES[1]) as made:
        other = made.module
        device = await made.manager.add(DeviceConfig("Wrong", NAMES[2], {"kind": "emulator"}))
        device.session.port.wire = other  # type: ignore[attr-defined]
        with pytest.raises(OtherModel) as told:
            await device.identify()
        assert NAMES[1] in told.value.found


async def test_the_boot_loader_is_never_started() -> None:
    async with bench() as made:
        with pytest.raises(WrongState, match="boot loader"):
            await made.device.need(TmclCommands).tmcl(242)


async def test_a_power_cycle_brings_back_what_was_stored() -> None:
    async with bench() as made:
        console, row = made.device.need(TmclCommands), made.row("max_speed")
        await made.device.registers.write(row.name, 0, 55)
        await console.tmcl("STAP", row.address)
        await made.device.registers.write(row.name, 0, 66)
        made.patch(power_cycle=True)
        assert (await made.device.registers.read(row.name, 0)).value == 55
        assert (await console.tmcl("RFS", "START")).status != 100
        assert (await console.tmcl("GAP", row.address, 9)).status == 4
