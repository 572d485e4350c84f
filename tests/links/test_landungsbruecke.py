"""Our own link to an evaluation board: registers, who is there, and staying in step with firmware that never forgets
half a frame. The board is `stepscope emulate landungsbruecke` in a process of its own, on a pty or a TCP port."""

from __future__ import annotations

import asyncio
import contextlib
import os
import random
from collections.abc import AsyncIterator, Sequence
from typing import cast

import pytest

from app.clock import VirtualClock
from app.errors import BadReply, LinkError, LinkTimeout, OutOfRange, UnknownThing, UsageError
from app.links.discovery import FoundModule, probe
from app.links.evaluation_board import Board, board_name, identify
from app.links.queue import LinkQueue, Priority
from app.links.register_access import BoardAccess
from app.links.registry import board_factory
from app.links.serial_line import LinePort
from app.links.tmcl import Reply, Request
from app.registers.evaluation_board import BoardOpcode
from app.registers.tmcl.commands import Opcode
from tests.peers.board import board, patch_board, shared_board
from tests.peers.emulator_process import EmulatorProcess

__all__ = ["board", "shared_board"]
ACCESS = BoardAccess()
PATIENCE_S = 20.0
POS_COMP, VIRT_STOP_LEFT, X_ACTUAL = 0x32, 0x33, 0x21


def port(**options: object) -> LinePort:
    link = {"kind": "landungsbruecke", **options}
    return cast("LinePort", board_factory("tmc4361", link, VirtualClock()))


@pytest.fixture(params=["pty", "tcp"])
async def queue(board: EmulatorProcess, request: pytest.FixtureRequest) -> AsyncIterator[LinkQueue]:
    if request.param == "pty":
        where = str(board.pty)
    else:
        assert board.tcp is not None
        where = f"socket://{board.tcp[0]}:{board.tcp[1]}"
    opened = LinkQueue(port(port=where, timeout_s=PATIENCE_S))
    yield opened
    await opened.port.aclose()


async def write(queue: LinkQueue, *writes: tuple[int, int]) -> None:
    frames = ACCESS.write_frames(writes)
    ACCESS.check_all(frames, await queue.exchange_many(frames))


async def read(queue: LinkQueue, addresses: Sequence[int], timeout_s: float | None = None) -> list[int]:
    frames = ACCESS.read_frames(addresses)
    replies = await queue.exchange_many(frames, timeout_s=timeout_s)
    ACCESS.check_all(frames, replies)
    return ACCESS.words(replies)


# --- registers ----------------------------------------------------------------------------------


async def test_registers_are_written_and_read(queue: LinkQueue) -> None:
    await write(queue, (POS_COMP, 0xFFFF_FFFE), (VIRT_STOP_LEFT, 0x8000_0000))
    assert await read(queue, [VIRT_STOP_LEFT, POS_COMP, 0x28]) == [0x8000_0000, 0xFFFF_FFFE, 320_000]


async def test_a_motor_moves_and_stops(queue: LinkQueue) -> None:
    await write(queue, (0x28, 400_000 << 2), (0x29, 400_000 << 2), (0x24, 100_000 << 8))
    while (await read(queue, [0x22]))[0] != 100_000:
        pass
    frame = ACCESS.write_frame(0x24, 0)
    ACCESS.check(frame, await queue.exchange(frame, Priority.STOP))
    while (await read(queue, [0x22]))[0]:
        pass
    assert (await read(queue, [X_ACTUAL]))[0] > 0


async def test_who_is_there(queue: LinkQueue) -> None:
    await write(queue, (POS_COMP, 99))
    found = await identify(queue)
    assert found == Board("Landungsbrücke", "0012V310", "TMC4361A", "TMC2660")
    assert str(found) == "Landungsbrücke with TMC4361A and TMC2660"
    assert await read(queue, [POS_COMP]) == [99], "asking resets nothing"


def test_names_of_boards() -> None:
    assert board_name("0026V400") == "Landungsbrücke V3"
    assert board_name("1241V144") is None
    assert board_name("\ufffdoo") is None
    assert str(Board("Startrampe", "0016V310", "", "")) == "Startrampe with empty slots"


# --- options ------------------------------------------------------------------------------------


def test_options() -> None:
    plain = port(port="/dev/ttyACM0")
    assert (plain.name, plain.baud, plain.address) == ("serial /dev/ttyACM0, module 1", 115200, 1)
    assert port(port="socket://h:4001", motor=1, timeout_s=0.5).name == "tcp h:4001, module 1"


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({}, UsageError),
        ({"port": "http://h"}, UsageError),
        ({"port": "x", "motor": 16}, OutOfRange),
        ({"port": "x", "motor": "0"}, OutOfRange),
        ({"port": "x", "baud": 1}, OutOfRange),
        ({"port": "x", "timeout_s": 0}, OutOfRange),
        ({"port": "x", "address": 1}, UnknownThing),
    ],
)
def test_options_that_cannot_be(options: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error):
        port(**options)


def test_chips_without_boards_have_no_such_link() -> None:
    with pytest.raises(UsageError, match="a tmc428 has no landungsbruecke link; tmc2130, tmc2240, tmc2660, tmc4361, "):
        board_factory("tmc428", {"kind": "landungsbruecke", "port": "x"}, VirtualClock())


# --- discovery ----------------------------------------------------------------------------------


async def test_a_search_finds_the_board_and_what_is_on_it(board: EmulatorProcess) -> None:
    where = str(board.pty)
    (found,) = await probe(where, [115200], [1, 2])
    assert found == FoundModule(where, 115200, 1, 12, "0012V310", board="Landungsbrücke with TMC4361A and TMC2660",
                                chip="TMC4361A")  # fmt: skip


# --- what goes wrong ----------------------------------------------------------------------------


@pytest.mark.parametrize("left", range(1, 9))
async def test_half_a_frame_of_somebody_who_went_is_filled_up(board: EmulatorProcess, left: int) -> None:
    """The board waits for the rest for ever: every later frame would be cut in two."""
    assert board.pty is not None
    line = os.open(board.pty, os.O_RDWR | os.O_NOCTTY)
    os.write(line, Request(1, BoardOpcode.READ_MC, X_ACTUAL).encode()[:left])
    os.close(line)
    queue = LinkQueue(port(port=str(board.pty), timeout_s=0.5))
    tries = 0
    while True:
        tries += 1
        with contextlib.suppress(LinkTimeout, BadReply):
            assert await read(queue, [0x28]) == [320_000]
            break
        assert tries < 6
    assert await read(queue, [0x28]) == [320_000]
    await queue.port.aclose()


async def test_a_thousand_corrupt_frames(board: EmulatorProcess) -> None:
    """To the board, and from it: no wrong value, nothing hangs, and in the end all is well again."""
    chance = random.Random(4361)
    queue = LinkQueue(port(port=str(board.pty), timeout_s=0.05))
    await write(queue, (POS_COMP, 0x1234_5678))
    assert board.pty is not None
    line = os.open(board.pty, os.O_RDWR | os.O_NOCTTY)
    good = bad = 0
    try:
        for number in range(1000):
            frame = bytearray(Request(1, BoardOpcode.READ_MC, POS_COMP).encode())
            for _ in range(chance.randrange(1, 4)):
                frame[chance.randrange(9)] ^= 1 << chance.randrange(8)
            if frame[1] in (BoardOpcode.WRITE_MC, Opcode.SAP):  # that one would rightly be obeyed
                continue
            os.write(line, bytes(frame[: chance.randrange(1, 10)]))
            if number % 40 == 0:
                try:
                    assert await read(queue, [POS_COMP]) == [0x1234_5678]
                    good += 1
                except LinkError:
                    bad += 1
    finally:
        os.close(line)
    assert bad, "somebody else's frames on the line are noticed"
    for _ in range(20):
        with contextlib.suppress(LinkError):
            assert await read(queue, [POS_COMP], 1.0) == [0x1234_5678]
            good += 1
    assert good > 10
    await queue.port.aclose()


@pytest.mark.parametrize(
    "faults",
    [{"bit_error_rate": 0.003}, {"half_frame_rate": 0.2}, {"bit_error_rate": 0.003, "late_reply_s": 0.02}],
    ids=["flipped", "cut", "late"],
)
async def test_bad_answers_are_never_believed(board: EmulatorProcess, faults: dict[str, float]) -> None:
    queue = LinkQueue(port(port=str(board.pty), timeout_s=0.03))
    for _ in range(10):
        with contextlib.suppress(LinkError):
            await write(queue, (POS_COMP, 0x0BAD_CAFE))
            break
    await asyncio.to_thread(patch_board, board, {"faults": faults}, "line")
    try:
        good = bad = 0
        for _ in range(50):
            try:
                assert await read(queue, [POS_COMP]) == [0x0BAD_CAFE]
                good += 1
            except LinkError:
                bad += 1
        assert bad
    finally:
        healed = {"bit_error_rate": 0.0, "half_frame_rate": 0.0, "late_reply_s": 0.0}
        await asyncio.to_thread(patch_board, board, {"faults": healed}, "line")
    for _ in range(10):
        with contextlib.suppress(LinkError):
            assert await read(queue, [POS_COMP], PATIENCE_S) == [0x0BAD_CAFE]
    assert await read(queue, [POS_COMP], PATIENCE_S) == [0x0BAD_CAFE]
    await queue.port.aclose()


async def test_a_silent_chip_reads_as_nothing_and_a_silent_board_not_at_all(board: EmulatorProcess) -> None:
    queue = LinkQueue(port(port=str(board.pty), timeout_s=0.3))
    await asyncio.to_thread(patch_board, board, {"chip": {"faults": {"silence": True}}})
    assert await read(queue, [0x28], PATIENCE_S) == [0]
    await asyncio.to_thread(patch_board, board, {"chip": {"faults": {"silence": False}}, "faults": {"silence": True}})
    with pytest.raises(LinkTimeout):
        await read(queue, [0x28])
    await asyncio.to_thread(patch_board, board, {"faults": {"silence": False}})
    assert await read(queue, [0x28], PATIENCE_S) == [320_000]
    await queue.port.aclose()


async def test_another_module_is_not_there(board: EmulatorProcess) -> None:
    queue = LinkQueue(port(port=str(board.pty), timeout_s=PATIENCE_S))
    reply = Reply.decode(await queue.exchange(Request(1, Opcode.GET_VERSION, 1).encode()))
    assert reply.value == 12 << 16 | 3 << 8 | 10
    with pytest.raises(LinkTimeout):
        await queue.exchange(Request(2, Opcode.GET_VERSION, 1).encode(), timeout_s=0.1)
    await queue.port.aclose()
