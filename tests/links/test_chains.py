"""Chips whose answers belong to the frame before: nobody may come between, whoever else wants the chip."""

from __future__ import annotations

import asyncio
import random
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager

import pytest

from app.clock import VirtualClock, WallClock
from app.emulators.server import serve_tcp
from app.emulators.tmc5xxx import EmulatedTmc5xxx
from app.emulators.tmc4361 import EmulatedTmc4361, Tmc4361Patch
from app.errors import BadReply, LinkDown, LinkTimeout
from app.links import datagram40
from app.links.emulator import EmulatorPort
from app.links.port import ChainPort
from app.links.queue import LinkQueue, Priority
from app.links.register_access import Spi40Access
from app.links.spidev_port import SpidevPort
from app.links.tcp import TcpPort
from tests.links.pty_module import until
from tests.links.server import serving

PLACES = (0x32, 0x33, 0x34, 0x37)
"""POS_COMP, VIRT_STOP_LEFT, VIRT_STOP_RIGHT, XTARGET: hold all 32 bits and do nothing while nothing is switched on."""
ACCESS = Spi40Access()


@asynccontextmanager
async def served() -> AsyncIterator[tuple[EmulatedTmc4361, int]]:
    chip = EmulatedTmc4361(WallClock())
    server = await serve_tcp(chip, "127.0.0.1", 0, half_frame_s=0.1)
    try:
        yield chip, server.sockets[0].getsockname()[1]
    finally:
        server.close()
        await server.wait_closed()


def tcp_port(port: int, timeout_s: float = 20.0) -> TcpPort:
    return TcpPort("127.0.0.1", port, timeout_s=timeout_s, frame_bytes=5, pipelined=True)


class SpiThatIsAChip:
    """What spidev offers, with an emulated chip at the bus: no machine that runs tests has one."""

    max_speed_hz = 0
    mode = 0
    bits_per_word = 0

    def __init__(self, chip: EmulatedTmc4361 | EmulatedTmc5xxx) -> None:
        self._chip = chip

    def open(self, bus: int, device: int) -> None:
        del bus, device

    def xfer2(self, values: list[int]) -> list[int]:
        return list(self._chip.transfer(bytes(values)))

    def close(self) -> None:
        pass


@pytest.fixture(params=["emulator", "tcp", "spidev"])
async def port(request: pytest.FixtureRequest) -> AsyncIterator[ChainPort]:
    if request.param == "emulator":
        yield EmulatorPort(EmulatedTmc4361(VirtualClock()))
    elif request.param == "spidev":
        chip = EmulatedTmc4361(WallClock())
        yield SpidevPort(0, 0, frame_bytes=5, make=lambda: SpiThatIsAChip(chip))
    else:
        async with served() as (_, number):
            far = tcp_port(number)
            yield far
            await far.aclose()


async def write(queue: LinkQueue, *writes: tuple[int, int], priority: Priority = Priority.COMMAND) -> None:
    frames = ACCESS.write_frames(writes)
    ACCESS.check_all(frames, await queue.exchange_many(frames, priority))


async def read(queue: LinkQueue, addresses: Sequence[int], priority: Priority = Priority.COMMAND) -> list[int]:
    frames = ACCESS.read_frames(addresses)
    replies = await queue.exchange_many(frames, priority)
    ACCESS.check_all(frames, replies)
    return ACCESS.words(replies)


async def test_each_of_many_askers_gets_its_own_words(port: ChainPort) -> None:
    """Stops and samples in the middle of others' chains, a thousand times: no word is anybody else's."""
    queue = LinkQueue(port, samples_waiting_max=100)
    chance = random.Random(4361)
    held = {place: chance.getrandbits(32) for place in PLACES}
    await write(queue, *held.items())

    async def asker(priority: Priority) -> None:
        for _ in range(100):
            asked = chance.choices(PLACES, k=chance.randrange(1, 5))
            assert await read(queue, asked, priority) == [held[place] for place in asked]
            await asyncio.sleep(0)

    async def writer() -> None:
        for _ in range(100):
            await write(queue, *held.items(), priority=Priority.STOP)
            await asyncio.sleep(0)

    await asyncio.gather(writer(), *(asker(priority) for priority in Priority for _ in range(3)))
    assert queue.counts.failures == 0
    assert [frame.rx[0] for frame in queue.log.page().frames]


class PassingClock(VirtualClock):
    """A little time passes whenever somebody looks."""

    def now(self) -> float:
        self.set(super().now() + 0.0002)
        return super().now()


async def test_a_stop_waits_for_the_end_of_a_chain() -> None:
    seen: list[bytes] = []
    begun, stop_waits = asyncio.Event(), asyncio.Event()

    async def answer(frame: bytes, writer: asyncio.StreamWriter) -> None:
        seen.append(frame)
        begun.set()
        await stop_waits.wait()
        writer.write(frame)

    async with serving(answer, frame_bytes=5) as server:
        queue = LinkQueue(tcp_port(server.port))
        chain, stop = ACCESS.read_frames([1, 2, 3]), ACCESS.write_frames([(0x24, 0)])
        reading = asyncio.create_task(queue.exchange_many(chain))
        await begun.wait()
        stopping = asyncio.create_task(queue.exchange_many(stop, Priority.STOP))
        await until(lambda: queue.waiting(Priority.STOP) > 0)
        stop_waits.set()
        await asyncio.gather(reading, stopping)
        assert seen == [*chain, *stop]
        await queue.port.aclose()


async def test_samples_that_fall_due_do_not_come_between() -> None:
    clock = PassingClock()
    port = EmulatorPort(EmulatedTmc4361(clock))
    queue = LinkQueue(port)
    held = dict(zip(PLACES, (1, 2, 3, 4), strict=True))
    await write(queue, *held.items())
    sampled: list[list[int]] = []
    end = port.start_sampling(
        ACCESS.read_frames([0x34, 0x33]),
        0.001,
        lambda _, joined: sampled.append(ACCESS.words([joined[at : at + 5] for at in range(0, len(joined), 5)])),
    )
    for _ in range(50):
        clock.set(clock.now() + 0.0011)
        assert await read(queue, PLACES) == [1, 2, 3, 4]
    end()
    assert len(sampled) > 60
    assert all(words == [3, 2] for words in sampled)


async def test_clients_of_one_chip_get_their_own_answers() -> None:
    async with served() as (_, number):
        queues = [LinkQueue(tcp_port(number)) for _ in range(3)]
        for queue, place in zip(queues, PLACES, strict=False):
            await write(queue, (place, place))

        async def ask(queue: LinkQueue, place: int) -> None:
            for _ in range(100):
                # Frame by frame: between two of them the others have the chip.
                replies = [await queue.exchange(frame) for frame in ACCESS.read_frames([place, place])]
                assert ACCESS.words(replies) == [place, place]

        await asyncio.gather(*(ask(queue, place) for queue, place in zip(queues, PLACES, strict=False)))
        for queue in queues:
            await queue.port.aclose()


async def test_a_chain_is_one_round_trip() -> None:
    asked: list[bytes] = []

    async def answer_late(frame: bytes, writer: asyncio.StreamWriter) -> None:
        asked.append(frame)
        if len(asked) == 4:  # nothing before all of it was sent
            writer.write(b"".join(asked))

    async with serving(answer_late, frame_bytes=5) as server:
        port = tcp_port(server.port)
        frames = ACCESS.read_frames([1, 2, 3])
        assert await port.exchange_chain(frames) == list(frames)
        await port.aclose()


async def test_a_chain_that_is_answered_in_part_counts_for_nothing() -> None:
    async with served() as (chip, number):
        queue = LinkQueue(tcp_port(number, timeout_s=0.3))
        await write(queue, (0x32, 5))
        chip.patch(Tmc4361Patch.model_validate({"faults": {"silence": True}}))
        with pytest.raises(LinkTimeout):
            await read(queue, PLACES)
        assert queue.log.page().frames[-1].error
        chip.patch(Tmc4361Patch.model_validate({"faults": {"silence": False}}))
        assert await read(queue, [0x32]) == [5], "in step at once, by a new connection"
        chip.patch(Tmc4361Patch.model_validate({"faults": {"unplugged": True}}))
        with pytest.raises(LinkDown):
            await read(queue, [0x32])
        await queue.port.aclose()


async def test_a_thousand_broken_frames_at_the_tcp_port() -> None:
    """Whatever bytes come in whatever pieces, the chip goes on, and the next one who asks gets what is right."""
    chance = random.Random(1000)
    async with served() as (_, number):
        queue = LinkQueue(tcp_port(number))
        for round_ in range(100):
            _, writer = await asyncio.open_connection("127.0.0.1", number)
            for _ in range(10):
                # Not a write: any register might be hit, and then the right word would be another one.
                garbage = bytearray(chance.randbytes(chance.randrange(1, 23)))
                for at in range(len(garbage)):
                    garbage[at] &= 0x7F
                writer.write(garbage)
                await writer.drain()
            writer.close()
            await write(queue, (0x32, round_), (0x33, ~round_ & 0xFFFF_FFFF))
            assert await read(queue, [0x33, 0x32]) == [~round_ & 0xFFFF_FFFF, round_]
        await queue.port.aclose()


async def test_half_a_frame_is_forgotten() -> None:
    async with served() as (_, number):
        reader, writer = await asyncio.open_connection("127.0.0.1", number)
        writer.write(datagram40.write(0x32, 9) + b"\x32\x00")
        assert len(await reader.readexactly(5)) == 5
        await asyncio.sleep(0.5)  # longer than the 0.1 s that the rest may take; a slow machine only makes it longer
        writer.write(datagram40.read(0x32) + datagram40.FETCH)
        assert (await reader.readexactly(10))[6:] == (9).to_bytes(4, "big")
        writer.close()


async def test_frames_of_another_length_are_not_sent(port: ChainPort) -> None:
    for frame in (b"", b"\x00" * 4, b"\x00" * 6):
        with pytest.raises(ValueError, match="5 bytes"):
            await port.exchange(frame)


async def test_a_reply_too_many_is_told() -> None:
    async def twice(frame: bytes, writer: asyncio.StreamWriter) -> None:
        writer.write(frame * 2)

    async with serving(twice, frame_bytes=5) as server:
        port = tcp_port(server.port)
        with pytest.raises(BadReply, match="10 bytes instead of 5"):
            await port.exchange(datagram40.FETCH)
        await port.aclose()
