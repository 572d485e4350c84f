"""Looking for modules: asks for versions and nothing else, leaves the port as it was, never disturbs a device."""

from __future__ import annotations

import asyncio
import os
import threading

import pytest

from app.errors import LinkDown, UsageError, WrongState
from app.links import discovery
from app.links.discovery import FoundModule, ProbeProgress, probe
from app.links.queue import LinkQueue
from app.links.tmcl import Reply
from app.registers.tmcl.commands import Opcode
from tests.links.pty_module import answer, gap, port_to, pty_module, right, silent, until, value_of


@pytest.fixture(autouse=True)
def _patience(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(discovery, "WAIT_S", 0.15)  # for modules that are threads on a busy machine


async def test_every_module_that_answers_is_found() -> None:
    with pty_module(addresses=(2, 4)) as module:
        before = len(os.listdir("/proc/self/fd")), threading.active_count()
        progress: list[ProbeProgress] = []
        found = await probe(module.path, [9600, 19200], [1, 2, 3, 4], progress.append)
        assert found == [
            FoundModule(module.path, baud, address, 1241, "1241V144") for baud in (9600, 19200) for address in (2, 4)
        ]
        assert [state.done for state in progress] == list(range(9))
        assert {state.total for state in progress} == {8}
        assert progress[2].asking == "address 3 at 9600 baud"
        assert list(progress[-1].found) == found
        assert {frame[1] for frame in module.seen} == {Opcode.GET_VERSION}
        assert (len(os.listdir("/proc/self/fd")), threading.active_count()) == before


async def test_a_module_with_half_a_frame_left_is_found() -> None:
    with pty_module() as module:

        def confused(module: object, frame: bytes) -> bytes:
            if len(module.seen) == 1:  # type: ignore[attr-defined]
                return b"\x55" + answer(frame) + b"\x55"
            return answer(frame)

        module.behave = confused
        assert [found.address for found in await probe(module.path, [9600], [1])] == [1]


async def test_a_search_can_be_ended() -> None:
    with pty_module(silent) as module:
        before = len(os.listdir("/proc/self/fd"))
        search = asyncio.create_task(probe(module.path, None, range(1, 200)))
        await until(lambda: len(module.seen) >= 3)
        search.cancel()
        with pytest.raises(asyncio.CancelledError):
            await search
        assert len(os.listdir("/proc/self/fd")) == before


async def test_a_line_that_a_device_has_open_is_asked_at_its_rate_and_goes_on() -> None:
    with pty_module(addresses=(1, 2)) as module:
        port = port_to(module, baud=115200)
        queue = LinkQueue(port)
        await queue.exchange(gap(1))
        working = asyncio.create_task(queue.exchange_many([gap(n % 256) for n in range(3000)]))
        assert [(found.baud, found.address) for found in await probe(module.path, None, [1, 2])] == [
            (115200, 1),
            (115200, 2),
        ]
        replies = await working
        assert [Reply.decode(reply).value for reply in replies] == [value_of(n % 256) for n in range(3000)]
        with pytest.raises(WrongState, match="open at 115200 baud"):
            await probe(module.path, [9600], [1])
        assert Reply.decode(await queue.exchange(gap(3))).value == value_of(3)
        module.behave = right
        await port.aclose()


async def test_ports_that_cannot_be() -> None:
    with pytest.raises(LinkDown, match="not there"):
        await probe("/dev/ttyNOPE7", [9600], [1])
    with pytest.raises(UsageError):
        await probe("http://example.com", [9600], [1])
