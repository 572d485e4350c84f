"""The threads that read recordings: few, bounded in what waits for them, and nobody else's."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator

import pytest

from app.errors import WrongState
from app.store.recordings.readers import Readers


async def test_whoever_reads_keeps_nobody_else_waiting_and_too_many_are_refused() -> None:
    readers, release = Readers(waiting_max=5), threading.Event()
    reading = [asyncio.create_task(readers.do(lambda: release.wait(20))) for _ in range(5)]
    await asyncio.sleep(0)
    with pytest.raises(WrongState, match="5 readings of recordings are under way; try again in a moment"):
        await readers.do(lambda: True)
    assert await asyncio.wait_for(asyncio.to_thread(lambda: 3), 10) == 3
    release.set()
    assert await asyncio.gather(*reading) == [True] * 5
    assert await readers.do(lambda: 4) == 4
    readers.close()


async def test_what_fails_or_is_given_up_frees_its_place() -> None:
    readers, release = Readers(waiting_max=1), threading.Event()

    def fail() -> None:
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        await readers.do(fail)
    given_up = asyncio.create_task(readers.do(lambda: release.wait(20)))
    await asyncio.sleep(0)
    given_up.cancel()
    release.set()
    with pytest.raises(asyncio.CancelledError):
        await given_up
    assert await readers.do(lambda: 4) == 4
    readers.close()


async def test_a_stream_is_made_when_it_is_taken() -> None:
    made: list[int] = []

    def pieces() -> Iterator[bytes]:
        for number in range(3):
            made.append(number)
            yield b"%d" % number

    readers = Readers()
    stream = await readers.stream(pieces())
    assert made == [0]
    assert [piece async for piece in stream] == [b"0", b"1", b"2"]
    readers.close()
