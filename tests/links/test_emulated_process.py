"""The link against `stepscope emulate` in a process of its own: faults switched while it is talked to."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from app.emulator_server.fault import change
from app.errors import BadReply, LinkDown, LinkTimeout
from app.links.queue import LinkQueue
from app.links.serial_line import LinePort, serial_port
from app.links.tmcl import Reply, Request
from app.registers.tmcl.commands import Opcode
from tests.links.pty_module import LONG_S, until
from tests.peers.emulator_process import EmulatorProcess, emulator

SHORT_S = 0.1
USER_VARIABLES = 20


@pytest.fixture(scope="module")
def module(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EmulatorProcess]:
    folder = tmp_path_factory.mktemp("emulator")
    flags = (
        "--control",
        "127.0.0.1:0",
        "--address",
        "1",
        "--address",
        "2",
        "--data-dir",
        str(folder),
        "--seed",
        "1241",
    )
    with emulator(*flags, pty=folder / "module") as process:
        yield process


@asynccontextmanager
async def port_to(process: EmulatorProcess, address: int = 1) -> AsyncIterator[LinePort]:
    assert process.pty is not None
    port = serial_port(str(process.pty), baud=115200, address=address, timeout_s=LONG_S)
    try:
        yield port
    finally:  # a line that a failure leaves open would fail every test that counts lines
        await port.aclose()


async def fault(process: EmulatorProcess, name: str, value: object) -> None:
    await asyncio.to_thread(change, process.control, name, str(value), line=True)


def sgp(number: int, value: int, address: int = 1) -> bytes:
    return Request(address, Opcode.SGP, number, 2, value).encode()


def ggp(number: int, address: int = 1) -> bytes:
    return Request(address, Opcode.GGP, number, 2).encode()


async def fill(queue: LinkQueue, address: int) -> list[int]:
    """Write user variables, all different; what they are now."""
    values = [address * 1_000_000 + 7919 * number for number in range(USER_VARIABLES)]
    await queue.exchange_many([sgp(number, value, address) for number, value in enumerate(values)])
    return values


async def once_in_step(queue: LinkQueue, frames: list[bytes]) -> list[bytes]:
    """The answers, as soon as nothing late fails them any more: how much is late is the emulator's to say."""
    for _ in range(20):
        with contextlib.suppress(BadReply, LinkTimeout):
            return await queue.exchange_many(frames)
    raise AssertionError("it does not get in step")


async def test_two_emulated_modules_on_one_line(module: EmulatorProcess) -> None:
    async with port_to(module, 1) as first, port_to(module, 2) as second:
        ports = (first, second)
        queues = [LinkQueue(port) for port in ports]
        values = [await fill(queue, address) for queue, address in zip(queues, (1, 2), strict=True)]
        read = await asyncio.gather(
            *(
                queue.exchange_many([ggp(number % USER_VARIABLES, address) for number in range(200)])
                for queue, address in zip(queues, (1, 2), strict=True)
            )
        )
        for replies, of_module in zip(read, values, strict=True):
            assert [Reply.decode(reply).value for reply in replies] == of_module * 10
        assert ports[0].incidents.counts == {"opened": 1}


@pytest.mark.parametrize(
    ("name", "value"), [("bit_error_rate", 0.003), ("half_frame_rate", 0.2), ("late_reply_s", 0.15), ("silence", True)]
)
async def test_no_wrong_value_through_any_fault(module: EmulatorProcess, name: str, value: float) -> None:
    async with port_to(module) as port:
        queue = LinkQueue(port)
        values = await fill(queue, 1)
        await fault(module, name, value)
        failed = 0
        for number in range(100 if name.endswith("rate") else 10):
            at = number % USER_VARIABLES
            try:
                reply = Reply.decode(await queue.exchange(ggp(at), timeout_s=SHORT_S))
            except (BadReply, LinkTimeout):
                failed += 1
            else:
                assert reply.status == 1 or reply.value == values[at]  # 1: the question arrived damaged
                failed += reply.status == 1
        assert failed > 3
        await fault(module, name, 0 if name != "silence" else False)
        replies = await once_in_step(queue, [ggp(number) for number in range(USER_VARIABLES)])
        assert [Reply.decode(reply).value for reply in replies] == values


async def test_unplugged_and_plugged_in_again(module: EmulatorProcess) -> None:
    async with port_to(module) as port:
        queue = LinkQueue(port)
        values = await fill(queue, 1)
        down: list[LinkDown] = []
        port.on_down(down.append)
        await fault(module, "unplugged", True)
        await until(lambda: bool(down))
        with pytest.raises(LinkDown, match="not there"):
            await queue.exchange(ggp(0))
        await fault(module, "unplugged", False)
        assert module.pty is not None
        await until(Path(module.pty).exists)
        assert Reply.decode(await queue.exchange(ggp(3))).value == values[3]


async def test_a_position_is_reached_while_others_are_asked_for(module: EmulatorProcess) -> None:
    async with port_to(module) as port:
        queue = LinkQueue(port)
        heard: list[bytes] = []
        foreign = port.incidents.counts.get("foreign", 0)  # of the line, which earlier tests may have kept alive
        port.on_event(heard.append)
        values = await fill(queue, 1)
        await queue.exchange(Request(1, Opcode.REQUEST_EVENT, 0, 0, 1).encode())
        await queue.exchange(Request(1, Opcode.MVP, 1, 0, 2000).encode())
        for _ in range(2000):
            reply = Reply.decode(await queue.exchange(ggp(5)))
            assert reply.value == values[5]
            if heard:
                break
        await until(lambda: bool(heard))
        assert [(frame[1], frame[2], frame[3]) for frame in heard] == [(1, 128, 138)]
        assert port.incidents.counts.get("foreign", 0) == foreign
