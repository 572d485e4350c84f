"""Parameters as registers: read back, refused with reasons, kept in EEPROM, and never cleared by a look."""

from __future__ import annotations

import pytest

from app.devices.core.capabilities import ParameterStore
from app.devices.core.results import WriteItem
from app.errors import LinkTimeout, OutOfRange, UnknownThing, WriteRefused, WrongState
from app.links.tmcl import Reply, Request
from app.registers.model import Space
from app.registers.tmcl.commands import Opcode, Status
from app.registers.tmcl.pd42 import PD42
from tests.devices.tmcl.harness import Tap, bench


async def test_a_write_is_read_back_under_any_of_its_names() -> None:
    async with bench() as b:
        for name, value in (("maximum_positioning_speed", 40_000), ("ap4", 30_000), ("AP4", 20_000)):
            written = await b.device.registers.write(name, 0, value)
            assert (written.name, written.value, written.verified) == ("maximum_positioning_speed", value, True)
            assert (written.space, written.address, written.axis) == (Space.AXIS, 4, 0)
        assert (await b.device.registers.read("ap4")).value == 20_000


async def test_every_kind_of_row_is_written_by_its_own_command() -> None:
    async with bench() as b:
        for name, opcode, motor in (
            ("ap7", Opcode.SAP, 0),
            ("gp0_68", Opcode.SGP, 0),
            ("user_variable_200", Opcode.SGP, 2),
            ("gp3_1", Opcode.SGP, 3),
            ("out0", Opcode.SIO, 2),
            ("coord5", Opcode.SCO, 0),
        ):
            assert (await b.device.registers.write(name, value=1)).verified is True
            sent = next(request for request in reversed(b.tap.frames) if request.opcode == opcode)
            assert (sent.motor, sent.value) == (motor, 1)


@pytest.mark.sheet("FM-PD42-1241", "4")
async def test_a_negative_value_comes_back_signed() -> None:
    async with bench() as b:
        written = await b.device.registers.write("stallguard2_threshold", 0, -12)
        assert (written.value, written.raw) == (-12, 0xFFFF_FFF4)


async def test_what_is_outside_the_row_never_reaches_the_module() -> None:
    async with bench() as b:
        frames = len(b.tap.frames)
        with pytest.raises(OutOfRange, match=r"maximum_current is 300, allowed is 0\.\.255"):
            await b.device.registers.write("maximum_current", 0, 300)
        with pytest.raises(WrongState, match="read only"):
            await b.device.registers.write("actual_speed", 0, 1)
        with pytest.raises(UnknownThing):
            await b.device.registers.write("no_such_parameter", 0, 1)
        assert len(b.tap.frames) == frames


@pytest.mark.parametrize(
    ("status", "error", "says"),
    [
        (Status.INVALID_VALUE, OutOfRange, r"global_current_scaler is 7, allowed is 0\.\.255; .*not allowed"),
        (Status.WRONG_TYPE, WrongState, "no such parameter"),
        (Status.EEPROM_LOCKED, WrongState, "EEPROM is locked"),
        (Status.NOT_AVAILABLE, WrongState, "not available now"),
        (Status.INVALID_COMMAND, WrongState, "does not know"),
    ],
)
@pytest.mark.sheet("FM-PD42-1241", "3.2.1")
async def test_a_status_becomes_an_error_that_names_the_way_out(
    status: Status, error: type[Exception], says: str
) -> None:
    def refuse(request: Request, reply: bytes) -> bytes:
        if request.opcode != Opcode.SAP:
            return reply
        return Reply(2, 1, status, request.opcode, request.value).encode()

    async with bench() as b:
        b.tap.spoil = refuse
        with pytest.raises(error, match=says):
            await b.device.registers.write("global_current_scaler", 0, 7)


async def test_a_value_that_the_module_does_not_take_is_no_success() -> None:
    async with bench() as b:
        held = (await b.device.registers.read("user_variable_1")).value

        def ignore(tap: Tap) -> None:
            def lie(request: Request, reply: bytes) -> bytes:
                if request.opcode == Opcode.GGP:
                    return Reply(2, 1, Status.OK, request.opcode, held).encode()
                return reply

            tap.spoil = lie

        ignore(b.tap)
        with pytest.raises(WriteRefused) as refused:
            await b.device.registers.write("user_variable_1", value=5)
        assert (refused.value.written, refused.value.read_back) == (5, held)


async def test_an_answer_that_is_lost_is_made_up_for_by_the_read_back() -> None:
    async with bench() as b:
        lost: list[Request] = []

        def lose_first(request: Request, reply: bytes) -> bytes:
            if request.opcode == Opcode.SAP and not lost:
                lost.append(request)
                raise TimeoutError
            return reply

        b.tap.spoil = lose_first
        written = await b.device.registers.write("standby_current", 0, 33)
        assert written.verified is True
        assert "answer was lost" in written.note
        assert b.tap.count(Opcode.SAP) == 1


async def test_what_the_module_changes_by_itself_proves_nothing() -> None:
    def later(request: Request, reply: bytes) -> bytes:
        return Reply(2, 1, Status.OK, Opcode.GGP, 1007).encode() if request.opcode == Opcode.GGP else reply

    async with bench() as b:
        b.tap.spoil = later
        written = await b.device.registers.write("tmcl_tick_timer", value=1000)
        assert (written.value, written.verified) == (1007, None)
        assert "by itself" in written.note


@pytest.mark.sheet("FM-PD42-1241", "7.2")
async def test_reading_all_clears_nothing() -> None:
    async with bench() as b:
        await b.device.registers.write("ap212", 0, 500)
        await b.device.motion.move(0, 51_200)
        b.patch(blocked=True)
        await b.clock.advance(0.5)
        asked = len(b.tap.frames)
        readings = await b.device.registers.read_all()
        cleared = [frame for frame in b.tap.frames[asked:] if (frame.opcode, frame.type) == (Opcode.GAP, 207)]
        assert cleared == []
        assert {reading.name for reading in readings} == {
            row.name for row in PD42 if row.access.readable and not row.read_clears
        }
        only = await b.device.registers.read_all(0)
        assert {reading.axis for reading in only} == {0}


async def test_flags_that_a_read_clears_stay_visible_until_the_next_motion() -> None:
    async with bench() as b:
        await b.device.registers.write("ap212", 0, 500)
        await b.device.motion.move(0, 51_200)
        b.patch(blocked=True)
        await b.clock.advance(2.0)
        assert (await b.device.monitor.axis_state(0)).flags["deviation_stop"]
        assert (await b.device.registers.read("extended_error_flags", 0)).value == 0, "whoever looked on has read it"
        assert (await b.device.monitor.axis_state(0)).flags["deviation_stop"]
        b.patch(blocked=False)
        await b.device.registers.write("ap212", 0, 0)
        await b.device.motion.move(0, 0)
        assert not (await b.device.monitor.axis_state(0)).flags["deviation_stop"]


@pytest.mark.sheet("FM-PD42-1241", "3.6.9")
@pytest.mark.sheet("FM-PD42-1241", "3.6.10")
async def test_a_variable_goes_to_eeprom_and_back() -> None:
    async with bench() as b:
        await b.device.registers.write("user_variable_7", value=123)
        assert (await b.device.need(ParameterStore).store("user_variable_7")).value == 123
        await b.device.registers.write("user_variable_7", value=9)
        assert (await b.device.need(ParameterStore).restore("user_variable_7")).value == 123


@pytest.mark.sheet("FM-PD42-1241", "3.6.22")
@pytest.mark.sheet("FM-PD42-1241", "3.6.23")
async def test_a_coordinate_goes_to_eeprom_and_back() -> None:
    async with bench() as b:
        await b.device.registers.write("coordinate_3", value=-777)
        await b.device.need(ParameterStore).store("coord3")
        await b.device.registers.write("coordinate_3", value=5)
        assert (await b.device.need(ParameterStore).restore("coord3")).value == -777


@pytest.mark.parametrize(
    ("name", "why"),
    [("ap4", "RAM alone"), ("user_variable_56", "RAM alone"), ("coord0", "RAM alone"), ("gp0_77", "by itself")],
)
async def test_what_cannot_be_stored_says_so(name: str, why: str) -> None:
    async with bench() as b:
        frames = len(b.tap.frames)
        with pytest.raises(WrongState, match=why):
            await b.device.need(ParameterStore).store(name)
        assert len(b.tap.frames) == frames


@pytest.mark.sheet("FM-PD42-1241", "7.4")
async def test_in_unit_mode_0_speeds_are_those_of_the_driver_chip() -> None:
    async with bench() as b:
        await b.device.registers.write("ap4", 0, 51_200)
        await b.device.registers.write("unit_mode", 0, 0)
        reading = await b.device.registers.read("ap4")
        assert (reading.value, reading.unit) == (53_687, "driver chip units")
        await b.device.registers.write("ap5", 0, 3)
        with pytest.raises(OutOfRange, match=r"allowed is 1\.\.65535"):
            await b.device.registers.write("ap5", 0, 70_000)
        await b.device.registers.write("ap5", 0, 4000)
        rotating = await b.device.motion.rotate(0, 30_000, "pps")
        assert rotating.velocity_chip == 31_457
        assert rotating.velocity_pps == pytest.approx(30_000, rel=1e-4)
        await b.clock.advance(1.0)
        state = await b.device.monitor.axis_state(0)
        assert state.velocity_pps == pytest.approx(30_000, rel=1e-4)


async def test_another_address_is_followed_and_told() -> None:
    async with bench() as b:
        written = await b.device.registers.write("serial_address", value=9)
        assert written.value == 9
        assert "address 9" in written.note


async def test_answers_are_not_switched_off_by_a_slip() -> None:
    async with bench() as b:
        with pytest.raises(WrongState, match="console"):
            await b.device.registers.write("suppress_reply", value=1)


async def test_a_batch_ends_at_its_first_failure() -> None:
    async with bench() as b:
        result = await b.device.registers.write_many(
            [WriteItem("ap4", 0, 1000), WriteItem("ap6", 0, 999), WriteItem("ap7", 0, 1)]
        )
        assert ([done.value for done in result.done], result.not_tried) == ([1000], 1)
        assert isinstance(result.failed, OutOfRange)


async def test_a_silent_module_is_asked_three_times_and_told_of() -> None:
    async with bench() as b:
        b.patch(faults={"silence": True})
        asked = len(b.tap.frames)
        with pytest.raises(LinkTimeout):
            await b.device.registers.read("ap1")
        assert len(b.tap.frames) - asked == 3


@pytest.mark.sheet("FM-PD42-1241", "3.6.12")
async def test_pull_ups_are_written_and_nobody_claims_to_have_read_them() -> None:
    async with bench() as b:
        assert (await b.device.registers.read("in1")).value == 1  # open, and pulled up
        written = await b.device.registers.write("input_pull_ups", value=1)
        assert (written.verified, written.note) == (None, "it cannot be read back")
        sent = b.tap.frames[-1]
        assert (sent.opcode, sent.type, sent.motor, sent.value) == (Opcode.SIO, 0, 0, 1)
        assert (await b.device.registers.read("in1")).value == 0
        with pytest.raises(WrongState, match="write only"):
            await b.device.registers.read("input_pull_ups")
        with pytest.raises(OutOfRange, match=r"0\.\.3"):
            await b.device.registers.write("input_pull_ups", value=4)
        assert "input_pull_ups" not in {reading.name for reading in await b.device.registers.read_all()}
