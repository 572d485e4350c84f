"""Who is next on the wire: deterministic, with every answer given by the test."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable

import pytest

from app.clock import VirtualClock
from app.emulators.build import build_emulator
from app.emulators.drive.documents import ChipFaultsChange
from app.emulators.tmc428.options import EmulatorPatch
from app.errors import LinkDown, LinkError, LinkTimeout, WrongState
from app.links import datagram32
from app.links.emulator import EmulatorPort
from app.links.queue import LinkQueue, Priority, SampleDropped, Turn
from tests.links.gate import GatedPort, settle

A, B, C, D = (datagram32.read(address) for address in (0x01, 0x02, 0x03, 0x04))


def soon(work: Awaitable[object]) -> asyncio.Task[object]:
    async def run() -> object:
        return await work

    return asyncio.create_task(run())


async def test_stop_overtakes_command_overtakes_sample() -> None:
    port = GatedPort()
    queue = LinkQueue(port)
    first = soon(queue.exchange(A, Priority.SAMPLE))
    await settle()
    waiting = []
    for frame, priority in ((B, Priority.SAMPLE), (C, Priority.COMMAND), (D, Priority.STOP)):
        waiting.append(soon(queue.exchange(frame, priority)))
        await settle()
    assert [queue.waiting(priority) for priority in Priority] == [1, 1, 1]
    await port.let_through(4)
    await asyncio.gather(first, *waiting)
    assert port.seen == [A, D, C, B]
    assert queue.counts.frames == [1, 1, 2]
    assert queue.counts.waited == 3
    assert not queue.busy


async def test_equals_are_served_in_order() -> None:
    port = GatedPort()
    queue = LinkQueue(port)
    tasks = []
    for frame in (A, B, C, D):
        tasks.append(soon(queue.exchange(frame)))
        await settle()
    await port.let_through(4)
    await asyncio.gather(*tasks)
    assert port.seen == [A, B, C, D]


async def two_frames(turn: Turn, first: bytes, second: bytes) -> None:
    async with turn:
        await turn.exchange(first)
        await turn.exchange(second)


async def test_a_stop_comes_between_two_frames_of_a_command_and_other_commands_do_not() -> None:
    port = GatedPort()
    queue = LinkQueue(port)
    command = soon(two_frames(queue.turn(), A, B))
    await settle()
    other = soon(queue.exchange(C))
    stop = soon(queue.exchange(D, Priority.STOP))
    await settle()
    await port.let_through(4)
    await asyncio.gather(command, other, stop)
    assert port.seen == [A, D, B, C]
    assert queue.counts.overtaken == 1


async def test_a_sample_of_many_frames_holds_a_command_up_by_one_frame_only() -> None:
    port = GatedPort()
    queue = LinkQueue(port)
    sample = soon(queue.sample([A, A, A, A]))
    await settle()
    command = soon(queue.exchange(B))
    await settle()
    await port.let_through(5)
    await asyncio.gather(sample, command)
    assert port.seen == [A, B, A, A, A]


async def test_samples_do_not_pile_up() -> None:
    port = GatedPort()
    queue = LinkQueue(port, samples_waiting_max=2)
    tasks = [soon(queue.exchange(A))]
    await settle()
    tasks += [soon(queue.sample([B])) for _ in range(2)]
    await settle()
    with pytest.raises(SampleDropped):
        await queue.sample([B])
    assert queue.counts.samples_dropped == 1
    await port.let_through(3)
    await asyncio.gather(*tasks)


async def test_a_guard_is_asked_right_before_each_frame() -> None:
    port = GatedPort()
    queue = LinkQueue(port)
    stopped = False

    def guard() -> None:
        if stopped:
            raise WrongState("stopped meanwhile")

    command = soon(two_frames(queue.turn(guard=guard), A, B))
    await settle()
    stopped = True
    await port.let_through(1)
    with pytest.raises(WrongState):
        await command
    assert port.seen == [A]
    assert not queue.busy


async def test_a_cancelled_waiter_is_skipped_and_the_link_lives_on() -> None:
    port = GatedPort()
    queue = LinkQueue(port)
    first, second, third = (soon(queue.exchange(frame)) for frame in (A, B, C))
    await settle()
    second.cancel()
    await settle()
    await port.let_through(2)
    await asyncio.gather(first, third)
    assert port.seen == [A, C]
    assert not queue.busy


async def test_cancelled_in_the_moment_of_its_turn_hands_the_link_on() -> None:
    port = GatedPort()
    queue = LinkQueue(port)
    turn = queue.turn()
    await turn.__aenter__()
    second = soon(queue.exchange(B))
    third = soon(queue.exchange(C))
    await settle()
    await turn.__aexit__(None, None, None)  # hands the link to the second, which has not run yet
    second.cancel()
    await settle()
    await port.let_through(1)
    await third
    assert port.seen == [C]
    assert not queue.busy


async def test_cancelled_while_overtaken_does_not_release_what_it_does_not_hold() -> None:
    port = GatedPort()
    queue = LinkQueue(port)
    command = soon(two_frames(queue.turn(), A, B))
    await settle()
    stop = soon(queue.exchange(D, Priority.STOP))
    await settle()
    await port.let_through(1)  # A is answered, D is on the wire, the command waits to go on
    command.cancel()
    await settle()
    assert queue.busy
    await port.let_through(1)
    await stop
    assert port.seen == [A, D]
    assert not queue.busy


async def test_what_waited_while_the_link_was_closed_does_not_go_out() -> None:
    port = GatedPort()
    queue = LinkQueue(port)
    first = soon(queue.exchange(A))
    await settle()
    waiting = [soon(queue.exchange(B)), soon(queue.sample([C])), soon(queue.beside().exchange(D, Priority.STOP))]
    await settle()
    queue.closed = True
    await port.let_through(1)
    await first
    for each in await asyncio.gather(*waiting, return_exceptions=True):
        assert isinstance(each, LinkDown), each
    assert port.seen == [A]
    assert queue.error is None
    assert not queue.busy
    queue.closed = False
    last = soon(queue.exchange(B))
    await settle()
    await port.let_through(1)
    await last
    assert port.seen == [A, B]


async def test_an_idle_link_needs_no_task_switch() -> None:
    queue = LinkQueue(EmulatorPort(build_emulator("tmc428", VirtualClock())))
    switched = False

    async def other() -> None:
        nonlocal switched
        switched = True

    task = asyncio.create_task(other())
    await queue.exchange(A)
    async with queue.turn() as turn:
        await turn.exchange(B)
    assert not switched
    await task


async def test_failures_are_counted_and_told_once_each_way() -> None:
    wire = build_emulator("tmc428", VirtualClock())
    told: list[LinkError | None] = []
    queue = LinkQueue(EmulatorPort(wire), on_result=told.append)
    wire.patch(EmulatorPatch(faults=ChipFaultsChange(silence=True)))
    for _ in range(2):
        with pytest.raises(LinkTimeout):
            await queue.exchange(A)
    assert queue.error is not None
    wire.patch(EmulatorPatch(faults=ChipFaultsChange(silence=False)))
    for _ in range(2):
        await queue.exchange(A)
    assert [type(error) for error in told] == [LinkTimeout, type(None)]
    assert (queue.counts.timeouts, queue.counts.failures) == (2, 2)
    assert queue.error is None
