"""Commands as they are: nine bytes or four fields, statuses as answers, and motion that is known of."""

from __future__ import annotations

import pytest

from app.devices.core.capabilities import TmclCommands
from app.devices.core.events import DeviceEvent, MotionCommanded
from app.devices.tmcl.state import ModuleState
from app.errors import LinkTimeout, OutOfRange, UnknownThing
from app.registers.tmcl.commands import Opcode
from tests.devices.tmcl.harness import bench


@pytest.mark.parametrize(
    ("command", "text"),
    [
        (("GAP", 4, 0, 0), "GAP 4, 0 -> 51200"),
        (("MVP", "ABS", 0, 100), "MVP ABS, 0, 100 -> "),
        ((136, 1), "-> 81330476"),
        (("SAP", 6, 0, 9999), "SAP 6, 0, 9999 -> status 4, invalid value"),
        ((99,), "command 99 0, 0, 0 -> status 2, invalid command"),
        ((136, 0), "-> 1241V144"),
    ],
)
async def test_an_exchange_reads_as_one_writes_it(command: tuple[int | str, ...], text: str) -> None:
    async with bench() as b:
        done = await b.device.need(TmclCommands).tmcl(*command)  # type: ignore[arg-type]
        assert text in done.text
        assert done.reply is not None
        assert len(done.reply) == len(done.request) == 9


@pytest.mark.parametrize("opcode", [137, 255])
async def test_what_is_never_answered_is_no_failure(opcode: int) -> None:
    async with bench() as b:
        done = await b.device.need(TmclCommands).tmcl(opcode, 0, 0, 1234)
        assert (done.reply, done.status, done.value) == (None, None, None)
        assert b.device.state == "connected"


async def test_names_and_numbers_are_checked_before_anything_is_sent() -> None:
    async with bench() as b:
        frames = len(b.tap.frames)
        with pytest.raises(UnknownThing, match="TMCL command"):
            await b.device.need(TmclCommands).tmcl("MVQ")
        with pytest.raises(UnknownThing, match="type of MVP"):
            await b.device.need(TmclCommands).tmcl("MVP", "RELATIVE", 0, 1)
        with pytest.raises(OutOfRange, match="motor"):
            await b.device.need(TmclCommands).tmcl("MVP", 0, 256, 1)
        with pytest.raises(OutOfRange, match="value"):
            await b.device.need(TmclCommands).tmcl("MVP", 0, 0, 1 << 32)
        with pytest.raises(OutOfRange, match="frame length"):
            await b.device.raw.exchange(bytes(8))
        assert len(b.tap.frames) == frames


async def test_a_raw_frame_is_sent_and_told_as_it_is() -> None:
    async with bench() as b:
        exchanged = await b.device.raw.exchange(bytes.fromhex("01 06 04 00 00 00 00 00 0B"))
        assert exchanged.decoded["value"] == 51_200
        assert exchanged.decoded["mnemonic"] == "GAP"
        wrong_sum = await b.device.raw.exchange(bytes.fromhex("01 06 04 00 00 00 00 00 0C"))
        assert wrong_sum.decoded["status_text"] == "wrong checksum"


@pytest.mark.parametrize(
    ("command", "moves"),
    [
        (("MVP", "ABS", 0, 100), True),
        (("ROR", 0, 0, 100), True),
        (("MST",), True),
        (("SAP", 0, 0, 100), True),
        (("SAP", 2, 0, 100), True),
        (("RFS", "START"), True),
        (("SAP", 4, 0, 100), False),
        (("GAP", 0, 0, 0), False),
        (("RFS", "STATUS"), False),
        ((136, 1), False),
    ],
)
async def test_what_may_move_the_motor_counts_as_a_command_to_the_axis(
    command: tuple[int | str, ...], moves: bool
) -> None:
    async with bench() as b:
        told: list[DeviceEvent] = []
        b.device.listen(told.append)
        await b.device.need(TmclCommands).tmcl(*command)  # type: ignore[arg-type]
        assert any(isinstance(event, MotionCommanded) for event in told) is moves
        assert bool(b.device.session.motion_commands[0]) is moves


async def test_a_move_by_hand_is_predicted_and_its_end_is_told() -> None:
    async with bench() as b:
        await b.device.need(TmclCommands).tmcl("MVP", "REL", 0, 20_000)
        expected = b.device.motion.prediction(0)
        assert expected is not None
        assert expected.position[-1] == pytest.approx(20_000, abs=1)
        await b.clock.advance(expected.duration_s + 0.3)
        assert [end.reason for end in b.device.monitor.motion_ends(0)] == ["target_reached"]


async def test_a_command_by_hand_is_never_sent_twice() -> None:
    async with bench() as b:
        b.patch(faults={"silence": True})
        with pytest.raises(LinkTimeout):
            await b.device.need(TmclCommands).tmcl("MVP", "ABS", 0, 100)
        with pytest.raises(LinkTimeout):
            await b.device.need(TmclCommands).tmcl("GAP", 1)
        assert b.tap.count(Opcode.MVP) == 1
        assert sum((frame.opcode, frame.type) == (Opcode.GAP, 1) for frame in b.tap.frames[-1:]) == 1


async def test_what_is_written_by_hand_is_not_remembered_otherwise() -> None:
    async with bench() as b:
        assert b.part(ModuleState).mechanics(0).microsteps_per_full_step == 256
        await b.device.need(TmclCommands).tmcl("SAP", 140, 0, 4)
        await b.device.motion.move(0, 1, unit="rev")
        assert next(frame.value for frame in b.tap.frames if frame.opcode == Opcode.MVP) == 3200
