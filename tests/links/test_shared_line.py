"""Several modules on one line: one transaction at a time, stops first, batches that give way."""

from __future__ import annotations

import asyncio

import pytest

from app.errors import LinkDown, LinkTimeout, WrongState
from app.links.port import Answer
from app.links.queue import LinkQueue, Priority, SampleDropped
from app.links.tmcl import Reply, Request
from app.registers.tmcl.commands import Opcode
from tests.links.gate import settle
from tests.links.pty_module import Gate, answer, but_version, gap, port_to, pty_module, silent, until, value_of

STOP_1, STOP_2 = (Request(address, Opcode.MST).encode() for address in (1, 2))


def values(replies: list[bytes]) -> list[int]:
    return [Reply.decode(reply).value for reply in replies]


async def test_a_batch_is_answered_in_order() -> None:
    with pty_module() as module:
        port = port_to(module)
        queue = LinkQueue(port)
        assert values(await queue.exchange_many([gap(n) for n in range(100)])) == [value_of(n) for n in range(100)]
        assert module.asked() == [gap(n) for n in range(100)]
        assert await queue.exchange_many([]) == []
        await port.aclose()


async def test_two_modules_on_one_line_take_turns() -> None:
    with pty_module(addresses=(1, 2)) as module:
        ports = [port_to(module, address=address) for address in (1, 2)]
        queues = [LinkQueue(port) for port in ports]
        assert ports[0].arbiter is ports[1].arbiter
        assert ports[0].incidents is ports[1].incidents
        replies = await asyncio.gather(
            *(queues[n % 2].exchange_many([gap(i, 1 + n % 2) for i in range(n, n + 5)]) for n in range(20))
        )
        for n, got in enumerate(replies):
            assert values(got) == [value_of(i, 1 + n % 2) for i in range(n, n + 5)]
        await ports[0].aclose()
        assert values([await queues[1].exchange(gap(7, 2))]) == [value_of(7, 2)]  # the line stays open for the other
        await ports[1].aclose()


@pytest.mark.parametrize("let_through", [1, 2, 30])
async def test_a_stop_waits_for_one_transaction_at_most(let_through: int) -> None:
    """Telemetry of one module saturates the line, the stop is for the other."""
    gate = Gate()
    with pty_module(gate, addresses=(1, 2)) as module:
        ports = [port_to(module, address=address) for address in (1, 2)]
        sampled, stopped = (LinkQueue(port) for port in ports)
        gate.let_through()
        await stopped.exchange(gap(0, 2))  # in step
        sample = asyncio.create_task(sampled.sample([gap(n) for n in range(60)]))
        await until(lambda: len(module.asked()) == 2)
        gate.let_through(let_through)
        await until(lambda: len(module.asked()) == 2 + let_through)
        before = len(module.asked())  # the last of them is on the wire
        stop = asyncio.create_task(stopped.exchange(STOP_2, Priority.STOP))
        await settle()
        gate.let_through(200)
        await stop
        asked = module.asked()
        assert asked.index(STOP_2) - before <= 0
        _, joined = await sample
        assert values([joined[at : at + 9] for at in range(0, len(joined), 9)]) == [value_of(n) for n in range(60)]
        assert sampled.counts.overtaken == 1
        for port in ports:
            await port.aclose()


async def test_a_stop_while_telemetry_never_pauses() -> None:
    """Nothing is gated here: how many frames are on the wire between the call and the stop is counted as it happens."""
    with pty_module(addresses=(1, 2)) as module:
        ports = [port_to(module, address=address) for address in (1, 2)]
        sampled, stopped = (LinkQueue(port) for port in ports)
        await stopped.exchange(gap(0, 2))

        async def saturate() -> None:
            while True:
                await sampled.sample([gap(n) for n in range(40)])

        telemetry = asyncio.create_task(saturate())
        for _ in range(50):
            await asyncio.sleep(0.003)
            before = len(module.seen)
            await stopped.exchange(STOP_2, Priority.STOP)
            # The module's thread may be behind by the one that it is answering.
            assert module.seen.index(STOP_2, before) - before <= 1
        telemetry.cancel()
        await asyncio.gather(telemetry, return_exceptions=True)
        for port in ports:
            await port.aclose()


async def test_a_command_comes_between_the_frames_of_a_sample_and_a_guard_is_asked_again() -> None:
    gate = Gate()
    with pty_module(gate) as module:
        port = port_to(module)
        queue = LinkQueue(port)
        stopped = False

        def guard() -> None:
            if stopped:
                raise WrongState("stopped meanwhile")

        async def command() -> None:
            async with queue.turn(guard=guard) as turn:
                await turn.exchange_many([gap(n) for n in range(10)])

        commanding = asyncio.create_task(command())
        await until(lambda: len(module.asked()) == 1)
        stop = asyncio.create_task(queue.exchange(STOP_1, Priority.STOP))
        await settle()
        stopped = True
        gate.let_through(10)
        await stop
        with pytest.raises(WrongState):
            await commanding
        assert module.asked() == [gap(0), STOP_1]
        assert not queue.busy
        await port.aclose()


async def test_a_cancelled_batch_ends_after_the_frame_on_the_wire() -> None:
    gate = Gate()
    with pty_module(gate) as module:
        port = port_to(module)
        queue = LinkQueue(port)
        batch = asyncio.create_task(queue.exchange_many([gap(n) for n in range(50)]))
        await until(lambda: len(module.asked()) == 1)
        batch.cancel()
        await asyncio.gather(batch, return_exceptions=True)
        gate.let_through(10)
        assert values([await queue.exchange(gap(99))]) == [value_of(99)]
        assert module.asked() == [gap(0), gap(99)]
        await port.aclose()


async def test_samples_tell_how_far_apart_their_frames_were() -> None:
    with pty_module() as module:
        port = port_to(module)
        queue = LinkQueue(port)
        before_s = port.device_time_s()
        at_s, _ = await queue.sample([gap(n) for n in range(30)])
        first_s, last_s = queue.sample_span_s
        assert before_s < first_s < at_s < last_s < port.device_time_s()
        assert at_s == pytest.approx((first_s + last_s) / 2)
        await port.aclose()


async def test_samples_of_all_modules_on_a_line_do_not_pile_up() -> None:
    gate = Gate()
    with pty_module(gate, addresses=(1, 2)) as module:
        ports = [port_to(module, address=address) for address in (1, 2)]
        one, two = (LinkQueue(port, samples_waiting_max=1) for port in ports)
        first = asyncio.create_task(one.sample([gap(1)]))
        await until(lambda: len(module.asked()) == 1)
        second = asyncio.create_task(two.sample([gap(1, 2)]))
        await settle()
        with pytest.raises(SampleDropped):
            await one.sample([gap(2)])
        gate.let_through(2)
        await asyncio.gather(first, second)
        for port in ports:
            await port.aclose()


async def test_every_frame_is_in_the_log_with_its_time_and_its_failure() -> None:
    with pty_module() as module:
        port = port_to(module)
        queue = LinkQueue(port)
        await queue.exchange_many([gap(1), gap(2)], Priority.SAMPLE)
        module.behave = but_version(lambda module, frame: b"" if frame == gap(4) else answer(frame))
        with pytest.raises(LinkTimeout):
            await queue.exchange_many([gap(3), gap(4), gap(5)], timeout_s=0.1)
        page = queue.log.page()
        assert [(entry.tx, entry.rx) for entry in page.frames] == [
            (gap(1), answer(gap(1))),
            (gap(2), answer(gap(2))),
            (gap(3), answer(gap(3))),
            (gap(4), b""),
        ]
        assert [entry.priority for entry in page.frames] == [Priority.SAMPLE] * 2 + [Priority.COMMAND] * 2
        assert "no reply" in page.frames[3].error
        assert not any(entry.error for entry in page.frames[:3])
        assert page.frames[3].took_s >= 0.1
        assert all(entry.took_s > 0 for entry in page.frames)
        assert queue.counts.frames == [0, 2, 2]
        await port.aclose()


async def test_what_the_line_carries_is_counted_for_all_its_modules() -> None:
    with pty_module(addresses=(1, 2)) as module:
        ports = [port_to(module, address=address, baud=1200) for address in (1, 2)]
        queues = [LinkQueue(port) for port in ports]
        wire = ports[0].wire
        assert wire is ports[1].wire
        possible = [wire.calls_per_s_possible]
        for port, queue in zip(ports, queues, strict=True):
            await queue.exchange(gap(1, port.address))
        assert 0 < queues[0].calls_per_s < wire.calls_per_s
        assert wire.share is not None
        await queues[0].exchange_many([gap(n) for n in range(100)])
        possible.append(wire.calls_per_s_possible)
        assert possible == [
            pytest.approx(1200 / 180),
            None,
        ]  # a pseudo-terminal does not mind its baud rate, and is found out
        for port in ports:
            await port.aclose()


async def test_modules_on_a_line_have_one_baud_rate() -> None:
    with pty_module(addresses=(1, 2)) as module:
        first = port_to(module, baud=9600)
        second = port_to(module, baud=19200, address=2)
        await first.exchange(gap(1))
        with pytest.raises(LinkDown, match=r"open at 9600 baud for .* module 1; use the same"):
            await second.exchange(gap(1, 2))
        await first.aclose()
        await second.exchange(gap(1, 2))
        await second.aclose()


async def test_commands_that_are_not_answered() -> None:
    with pty_module(but_version(silent)) as module:
        port = port_to(module)
        queue = LinkQueue(port)
        factory, reset = (Request(1, opcode, value=1234).encode() for opcode in (137, 255))
        assert await queue.exchange(factory, answer=Answer.NEVER) == b""
        assert await queue.exchange(reset, timeout_s=0.02, answer=Answer.MAYBE) == b""
        module.behave = but_version(lambda module, frame: answer(frame))
        assert await queue.exchange(reset, answer=Answer.MAYBE) == answer(reset)
        assert values([await queue.exchange(gap(1))]) == [value_of(1)]
        assert module.asked() == [factory, reset, reset, gap(1)]
        await port.aclose()
