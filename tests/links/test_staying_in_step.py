"""What comes over a TMCL line and is not the answer: never taken for it, told, and got over."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import random
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from app.errors import BadReply, LinkTimeout
from app.links.incidents import IncidentKind
from app.links.queue import LinkQueue
from app.links.serial_line import LinePort
from app.links.tmcl import Reply, Request, sound, version_string
from app.links.tmcl_session import FENCES
from app.registers.tmcl.commands import Opcode, Status
from tests.links.pty_module import (
    LONG_S,
    PART_S,
    PtyModule,
    answer,
    but_version,
    gap,
    port_to,
    pty_module,
    right,
    silent,
    until,
    value_of,
)

SHORT_S = 0.03
"""Time-out of exchanges that are meant to run into it."""
BAUD = 115200
EVENT = bytes.fromhex("0201808a000000010e")
STOP = Request(1, Opcode.MST).encode()


@asynccontextmanager
async def line(addresses: tuple[int, ...] = (1,), baud: int = BAUD) -> AsyncIterator[tuple[PtyModule, LinePort]]:
    """A module and a port that is in step with it."""
    with pty_module(addresses=addresses) as module:
        port = port_to(module, baud=baud)
        assert await value(port, 0) == value_of(0)
        try:
            yield module, port
        finally:
            await port.aclose()


async def value(port: LinePort, number: int, timeout_s: float | None = None) -> int:
    return Reply.decode(await port.exchange(gap(number), timeout_s)).value


def kinds(port: LinePort) -> list[IncidentKind]:
    return [incident.kind for incident in port.incidents.list()]


async def test_a_line_is_in_step_before_the_first_question() -> None:
    """A module may still owe an answer to whoever had the line before us."""
    with pty_module() as module:

        def owing(module: PtyModule, frame: bytes) -> bytes:
            module.behave = right
            return answer(gap(77)) + right(module, frame)

        module.behave = owing
        port = port_to(module)
        assert await value(port, 5) == value_of(5)
        assert [frame[1] for frame in module.seen] == [Opcode.GET_VERSION, Opcode.GAP]
        await port.aclose()


async def test_a_late_answer_is_thrown_away() -> None:
    async with line() as (module, port):
        module.behave = silent
        with pytest.raises(LinkTimeout) as caught:
            await port.exchange(gap(1), SHORT_S)
        assert caught.value.waited_s == SHORT_S
        module.behave = right
        module.say(answer(gap(1)))
        assert await value(port, 2) == value_of(2)
        assert kinds(port) == ["opened", "timeout", "late", "resync"]
        assert port.incidents.counts["timeout"] == 1


async def test_a_late_answer_that_comes_after_the_next_question_is_not_its_answer() -> None:
    """Worst case: both ask for the same, so opcode, module and checksum of the old answer fit the new question."""
    async with line() as (module, port):
        held: list[bytes] = []

        def hold(module: PtyModule, frame: bytes) -> bytes:
            held.append(Reply(2, 1, 100, Opcode.GAP, 111).encode())
            module.behave = first_the_held
            return b""

        def first_the_held(module: PtyModule, frame: bytes) -> bytes:
            old, held[:] = b"".join(held), []
            return old + right(module, frame)

        module.behave = hold
        with pytest.raises(LinkTimeout):
            await value(port, 1, SHORT_S)
        assert await value(port, 1) == value_of(1)
        assert await value(port, 2) == value_of(2)


async def test_an_unanswered_fence_keeps_the_next_question_from_going_out() -> None:
    async with line() as (module, port):
        module.behave = silent
        with pytest.raises(LinkTimeout):
            await value(port, 1, SHORT_S)
        with pytest.raises(LinkTimeout, match=r"asked command 136 first; so frame 01 06 02 .* was not sent"):
            await value(port, 2, SHORT_S)
        assert module.asked() == [gap(0), gap(1)]
        # The answer to the lost fence comes while nobody asks.
        module.behave = right
        module.say(answer(Request(1, Opcode.GET_VERSION, 1).encode()))
        await until(lambda: kinds(port)[-1] == "late")
        assert await value(port, 3) == value_of(3)


async def test_the_answer_to_a_lost_fence_is_not_that_to_the_next_one() -> None:
    """Else the question behind it would get the answer that is still on its way to the first one."""
    async with line() as (module, port):
        module.behave = silent
        for index in (1, 2):  # the question, then the fence before the second one
            with pytest.raises(LinkTimeout):
                await value(port, index, SHORT_S)

        def one_behind(module: PtyModule, frame: bytes) -> bytes:
            return answer(module.seen[-2])

        module.behave = one_behind
        with pytest.raises(LinkTimeout, match="was not sent"):
            await value(port, 3, SHORT_S)
        assert module.asked()[-1] != gap(3)

        def both(module: PtyModule, frame: bytes) -> bytes:
            module.behave = right
            return one_behind(module, frame) + right(module, frame)

        module.behave = both
        assert await value(port, 4) == value_of(4)


async def test_a_module_that_stays_silent_is_asked_anew_each_time() -> None:
    async with line() as (module, port):
        module.behave = silent
        for _ in range(8):
            with pytest.raises(LinkTimeout):
                await value(port, 1, SHORT_S)
        await until(lambda: len(module.seen) >= 10)  # the peer is a thread, and the time limits are short
        fences = [frame[1] for frame in module.seen[3:]]  # in step at first; then a question
        assert len(fences) == 7
        assert len(set(fences)) > 3
        assert all(first != second for first, second in itertools.pairwise(fences))
        module.behave = right
        assert await value(port, 1) == value_of(1)


@pytest.mark.parametrize(
    ("spoil", "kind", "text"),
    [
        (lambda reply: reply[:4], "short", "4 bytes instead of 9"),
        (lambda reply: reply[:8] + bytes([reply[8] ^ 1]), "checksum", "checksum"),
        (lambda reply: b"\x00" + reply, "checksum", "checksum"),
        (lambda reply: answer(Request(1, Opcode.SAP, 4, 0, 5).encode()), "mismatch", "command 5 instead of 6"),
        (lambda reply: answer(gap(1, 2)), "foreign", "another master talks on the line: module 2 answered"),
        (lambda reply: reply + b"\x55", "foreign", "another master talks on the line: 1 bytes more"),
        (lambda reply: reply + reply, "foreign", "another master talks on the line"),
        (lambda reply: gap(1), "mismatch", "switch off the echo"),
    ],
)
async def test_wrong_answers_are_told_and_the_next_is_right(spoil: object, kind: str, text: str) -> None:
    assert callable(spoil)
    async with line() as (module, port):
        module.behave = but_version(lambda module, frame: bytes(spoil(answer(frame))))
        with pytest.raises(BadReply, match=text):
            await value(port, 1, PART_S if kind == "short" else LONG_S)
        module.behave = right
        assert await value(port, 2) == value_of(2)
        assert kinds(port)[1] == kind
        assert kinds(port)[-1] == "resync"
        assert module.asked() == [gap(0), gap(1), gap(2)]  # nothing was asked twice


async def test_an_answer_in_pieces_is_one_answer() -> None:
    async with line() as (module, port):
        pieces: list[threading.Timer] = []

        def slowly(module: PtyModule, frame: bytes) -> bytes:
            reply = answer(frame)
            pieces.append(threading.Timer(0.01, module.say, [reply[4:]]))
            pieces[-1].start()
            return reply[:4]

        module.behave = slowly
        assert await value(port, 1, timeout_s=5) == value_of(1)
        for piece in pieces:
            piece.join()


async def test_what_the_module_could_not_read_is_an_answer_and_no_value() -> None:
    async with line() as (module, port):
        module.behave = but_version(lambda module, frame: bytes.fromhex("020101000000000004"))
        assert Reply.decode(await port.exchange(gap(1))).status == 1
        module.behave = right
        assert await value(port, 2) == value_of(2)
        assert kinds(port) == ["opened", "damaged", "resync"]


async def test_events_come_whenever_they_like_and_answer_nothing() -> None:
    async with line() as (module, port):
        heard: list[bytes] = []
        end = port.on_event(heard.append)
        loop_thread = threading.get_ident()
        threads: set[int] = set()
        port.on_event(lambda _: threads.add(threading.get_ident()))

        module.say(EVENT)  # while nobody asks
        await until(lambda: len(heard) == 1)
        module.say(EVENT[:5])  # in pieces, with a question meanwhile
        await asyncio.sleep(0)
        module.say(EVENT[5:])
        assert await value(port, 1) == value_of(1)
        await until(lambda: len(heard) == 2)
        module.behave = but_version(lambda module, frame: EVENT + answer(frame))
        assert await value(port, 2) == value_of(2)
        module.behave = but_version(lambda module, frame: answer(frame) + EVENT)
        assert await value(port, 3) == value_of(3)
        module.behave = but_version(lambda module, frame: EVENT)
        with pytest.raises(LinkTimeout):
            await value(port, 4, SHORT_S)
        module.say(EVENT)  # among what is drained
        module.behave = lambda module, frame: EVENT + right(module, frame)  # and in the fence
        assert await value(port, 5) == value_of(5)
        await until(lambda: len(heard) == 8)
        assert set(heard) == {EVENT}
        assert threads == {loop_thread}
        end()
        module.say(EVENT)
        module.behave = right
        assert await value(port, 6) == value_of(6)
        assert len(heard) == 8
        assert set(kinds(port)) == {"opened", "timeout", "resync"}


async def test_an_event_is_for_the_module_that_sent_it() -> None:
    async with line(addresses=(1, 2)) as (module, one):
        two = port_to(module, 2, BAUD)
        await two.exchange(gap(1, 2))
        heard: list[tuple[int, bytes]] = []
        one.on_event(lambda frame: heard.append((1, frame)))
        two.on_event(lambda frame: heard.append((2, frame)))
        of_two = Reply(2, 2, 128, 138, 1).encode()
        module.say(EVENT + of_two)
        await until(lambda: len(heard) == 2)
        assert heard == [(1, EVENT), (2, of_two)]
        await two.aclose()


async def test_somebody_else_asks_between_our_questions() -> None:
    """The other host's question and its answer are heard; nothing of ours goes out before that is told."""
    async with line() as (module, port):
        module.say(gap(9) + answer(gap(9)))
        await until(lambda: "foreign" in kinds(port))
        with pytest.raises(BadReply, match="18 bytes that nobody asked for; the command was not sent"):
            await value(port, 1)
        assert await value(port, 2) == value_of(2)
        assert module.asked() == [gap(0), gap(2)]


async def test_somebody_else_asks_during_our_batch() -> None:
    async with line() as (module, port):
        queue = LinkQueue(port)

        def other_host(module: PtyModule, frame: bytes) -> bytes:
            return gap(9) + answer(gap(9)) + answer(frame) if frame == gap(5) else answer(frame)

        module.behave = but_version(other_host)
        with pytest.raises(BadReply):
            await queue.exchange_many([gap(n) for n in range(10)])
        module.behave = right
        assert await value(port, 2) == value_of(2)


async def test_a_foreign_answer_that_fits_is_found_out_by_the_one_too_many() -> None:
    async with line() as (module, port):
        other = Reply(2, 1, 100, Opcode.GAP, 4711).encode()
        module.behave = but_version(lambda module, frame: other + answer(frame))
        with pytest.raises(BadReply, match="another master"):
            await value(port, 1)


async def test_a_line_that_never_falls_silent() -> None:
    async with line(baud=1200) as (module, port):  # so slow that no pause of a busy machine is silence
        module.behave = silent
        with pytest.raises(LinkTimeout):
            await value(port, 1, SHORT_S)
        over = threading.Event()

        def babble() -> None:
            while not over.wait(0.0005):
                module.say(b"\xaa" * 3)

        babbler = threading.Thread(target=babble, daemon=True)
        babbler.start()
        try:
            with pytest.raises(BadReply, match="does not fall silent"):
                await value(port, 2)
        finally:
            over.set()
            babbler.join()
        module.behave = right
        assert await value(port, 3) == value_of(3)


async def test_a_stop_goes_out_at_once_whatever_state_the_line_is_in() -> None:
    async with line() as (module, port):
        module.behave = silent
        with pytest.raises(LinkTimeout):
            await value(port, 1, SHORT_S)
        module.behave = lambda module, frame: answer(gap(1)) + answer(frame)  # the late one, and then its own
        before = len(module.seen)
        assert Reply.decode(await port.exchange(STOP)).opcode == Opcode.MST
        assert module.seen[before:] == [STOP]
        module.behave = right
        module.say(gap(9) + answer(gap(9)))
        await until(lambda: "foreign" in kinds(port) or kinds(port)[-1] == "late")
        before = len(module.seen)
        assert Reply.decode(await port.exchange(STOP)).opcode == Opcode.MST
        assert module.seen[before:] == [STOP]


async def test_answers_without_a_checksum() -> None:
    async with line() as (module, port):
        string, binary = (Request(1, Opcode.GET_VERSION, form).encode() for form in (0, 1))
        assert version_string(await port.exchange(string)) == "1241V144"
        assert Reply.decode(await port.exchange(binary)).value >> 16 == 1241
        # An old answer has the right length, and is no text.
        module.behave = lambda module, frame: answer(gap(1)) if frame == string else right(module, frame)
        with pytest.raises(BadReply):
            await port.exchange(string)
        module.behave = lambda module, frame: b"\x02" + b"\x00\xff" * 4 if frame[1] == 134 else right(module, frame)
        assert await port.exchange(Request(1, Opcode.READ_MEMORY).encode()) == b"\x02" + b"\x00\xff" * 4


async def test_a_dead_module_does_not_hold_up_the_other_on_its_line() -> None:
    async with line(addresses=(1, 2)) as (module, dead):
        alive = port_to(module, 2, BAUD)
        module.addresses = (2,)
        with pytest.raises(LinkTimeout):
            await dead.exchange(gap(1), SHORT_S)
        for number in range(5):
            assert Reply.decode(await alive.exchange(gap(number, 2))).value == value_of(number, 2)
        # Its answer comes late, and while the other one is asked.
        module.behave = lambda module, frame: answer(gap(3)) + answer(frame)
        assert Reply.decode(await alive.exchange(gap(6, 2))).value == value_of(6, 2)
        await alive.aclose()


def corrupt(chance: random.Random, reply: bytes, old: list[bytes]) -> bytes:
    """One of the things that lines do to an answer, or nothing. What is changed is never sound by chance."""
    kind = chance.randrange(9)
    if kind == 0:
        return b""
    if kind == 1:
        return reply[: chance.randrange(1, 9)]
    if kind == 2:
        at = chance.randrange(9)
        return reply[:at] + bytes([reply[at] ^ 1 << chance.randrange(8)]) + reply[at + 1 :]
    if kind == 3:
        return chance.randbytes(chance.randrange(1, 30))
    if kind == 4:
        return reply + chance.randbytes(chance.randrange(1, 12))
    if kind == 5 and old:
        return old[chance.randrange(len(old))] + reply
    if kind == 6:
        at = chance.randrange(9)
        return reply[:at] + chance.randbytes(1) + reply[at:]
    if kind == 7:
        old.append(reply)  # too late: it comes before another one's
        return b""
    return reply


async def test_noise_that_looks_like_a_wrong_checksum_does_not_keep_a_module_out_of_step() -> None:
    """Filling up is for a module that holds half a frame; one that holds none is left with the padding."""
    async with line() as (module, port):
        module.behave = silent
        with pytest.raises(LinkTimeout):
            await value(port, 1, SHORT_S)
        module.behave = lambda module, frame: answer(frame, Status.WRONG_CHECKSUM)
        with pytest.raises(LinkTimeout, match="was not sent"):
            await value(port, 1)
        module.behave = right
        for _ in range(2):
            with contextlib.suppress(LinkTimeout):
                assert await value(port, 1, 1.0) == value_of(1)
        assert await value(port, 2) == value_of(2)


async def test_a_thousand_corrupt_answers() -> None:
    """No value is wrong that the protocol can tell, nothing hangs, and the line comes back each time."""
    chance = random.Random(1241)
    old: list[bytes] = []
    async with line() as (module, port):
        module.behave = but_version(lambda module, frame: corrupt(chance, answer(frame), old))
        good = bad = 0
        for number in range(1000):
            try:
                got = await value(port, number % 256, timeout_s=0.008)
            except (LinkTimeout, BadReply):
                bad += 1
            else:
                assert got == value_of(number % 256)
                good += 1
        module.behave = right
        for _ in range(3):  # what is still on the wire may cost one more
            with contextlib.suppress(LinkTimeout, BadReply):
                assert await value(port, 1) == value_of(1)
        assert await value(port, 2) == value_of(2)
        assert good > 50
        assert bad > 300
        assert len(port.incidents.list()) == 200
        assert sum(port.incidents.counts.values()) > 1000
        # Noise may look like a wrong checksum; then the module is filled up, and what it makes of that is no command.
        commands = [frame for frame in module.seen if sound(frame)]
        # GAP is one of them; and a busy machine may lose a fence, and then another one is sent
        assert {frame[1] for frame in commands} <= FENCES.keys()
        asked = [frame for frame in commands if frame[1] == Opcode.GAP and frame[2] != FENCES[Opcode.GAP]]
        assert len(asked) <= 1 + 1000 + 1 - 4  # nothing was asked twice
