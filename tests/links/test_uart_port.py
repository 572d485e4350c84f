"""Our end of the single wire: registers, writes that were counted, the echo, and staying in step.

The peer is a thread that answers by a script; `test_uart_emulated` has the emulated chips.
"""

from __future__ import annotations

import asyncio
import contextlib
import random
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import cast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.errors import BadReply, LinkDown, LinkError, LinkTimeout, OutOfRange, UnknownThing, UsageError
from app.links.datagram_uart import IFCNT, UartForm
from app.links.incidents import IncidentKind
from app.links.queue import LinkQueue, Priority
from app.links.register_access import UartAccess
from app.links.registry import uart_factory
from app.links.serial_line import serial_port
from app.links.uart_line import UartPort
from app.links.uart_session import Echo
from tests.links.gate import settle
from tests.links.pty_chip import AMAX, VMAX, XACTUAL, XTARGET, PtyChip, but_fences, port_to, pty_chip, right, word_of
from tests.links.pty_module import PART_S, PtyModule, silent, until

SHORT_S = 0.05
"""Time-out of exchanges that are meant to run into it."""
NODE = UartForm(0)
READ = NODE.read(XACTUAL)


@asynccontextmanager
async def line(
    nodes: tuple[int | None, ...] = (0,), *, echo: bool = False, say: Echo = "auto"
) -> AsyncIterator[tuple[PtyChip, UartPort]]:
    """Chips, and a port to the first of them that is in step."""
    with pty_chip(nodes, echo=echo) as chip:
        port = port_to(chip, nodes[0], say)
        assert await word(port, XACTUAL) == word_of(XACTUAL, nodes[0])
        try:
            yield chip, port
        finally:
            await port.aclose()


async def word(port: UartPort, register: int, timeout_s: float | None = None) -> int:
    reply = await port.exchange(port.form.read(register), timeout_s)
    return port.form.data_of(register, reply)


async def write(port: UartPort, *writes: tuple[int, int]) -> None:
    access = UartAccess(form=port.form)
    frames = access.write_frames(writes)
    access.check_all(frames, await LinkQueue(port).exchange_many(frames))


def kinds(port: UartPort) -> list[IncidentKind]:
    return [incident.kind for incident in port.incidents.list()]


# --- registers ----------------------------------------------------------------------------------


@pytest.mark.parametrize("echo", [False, True], ids=["two wires", "one wire"])
@pytest.mark.parametrize("node", [0, 7, 254, None])
async def test_what_is_written_is_read(node: int | None, echo: bool) -> None:
    async with line((node,), echo=echo) as (chip, port):
        await write(port, (VMAX, 200_000), (XTARGET, 0xFFFF_FE0C), (XTARGET, 5))
        assert chip.words[node, IFCNT] == 3
        access = UartAccess(form=port.form)
        frames = access.read_frames([XTARGET, VMAX, XACTUAL, XTARGET])
        replies = await LinkQueue(port).exchange_many(frames)
        access.check_all(frames, replies)
        assert access.words(replies) == [5, 200_000, word_of(XACTUAL, node), 5]
        assert kinds(port) == ["opened"]


async def test_each_write_is_counted_before_the_next_goes_out() -> None:
    async with line() as (chip, port):
        chip.seen.clear()
        await write(port, (AMAX, 1), (VMAX, 2), (XTARGET, 3))
        counting = NODE.read(IFCNT)
        assert chip.seen == [
            counting, NODE.write(AMAX, 1), counting, NODE.write(VMAX, 2), counting, NODE.write(XTARGET, 3), counting,
        ]  # fmt: skip
        chip.seen.clear()
        await write(port, (AMAX, 1))
        assert chip.seen == [NODE.write(AMAX, 1), counting], "the count is known now"


async def test_the_count_goes_round() -> None:
    async with line() as (chip, port):
        for value in range(300):
            await write(port, (AMAX, value))
        assert chip.words[0, IFCNT] == 300 % 256


async def test_a_write_that_is_not_counted_has_not_happened() -> None:
    async with line() as (chip, port):

        def deaf_to_writes(module: PtyModule, frame: bytes) -> bytes:
            return b"" if NODE.is_write(frame) else right(module, frame)

        await write(port, (AMAX, 1))
        chip.behave = deaf_to_writes
        with pytest.raises(BadReply, match="counted 0 writes instead of 1: what was sent has not arrived"):
            await write(port, (AMAX, 2), (VMAX, 3))
        assert chip.words[0, AMAX] == 1
        assert NODE.write(VMAX, 3) not in chip.seen, "and what follows is not sent"
        assert kinds(port)[-1] == "damaged"
        chip.behave = right
        await write(port, (AMAX, 4))
        assert chip.words[0, AMAX] == 4


async def test_a_chip_that_was_reset_or_has_another_master_is_told() -> None:
    async with line() as (chip, port):
        await write(port, (AMAX, 1), (AMAX, 2), (AMAX, 3))
        chip.words[0, IFCNT] = 0
        with pytest.raises(BadReply, match="it was reset, or another master writes to it"):
            await write(port, (AMAX, 4))
        await write(port, (AMAX, 5))
        assert kinds(port) == ["opened", "foreign"]


async def test_what_is_no_datagram_to_this_chip_is_refused() -> None:
    async with line((3,)) as (chip, port):
        before = len(chip.seen)
        for frame in (b"", b"\x05\x03", UartForm(2).read(0), UartForm(3).read(0)[:-1] + b"\0", UartForm(None).read(0)):
            with pytest.raises(ValueError, match=r"datagram|CRC"):
                await port.exchange(frame)
        assert len(chip.seen) == before


# --- the echo -----------------------------------------------------------------------------------


async def test_whether_there_is_an_echo_is_found_out_and_said_otherwise_is_told() -> None:
    for echo, say, hint in ((True, "off", "set echo to auto"), (False, "on", "set echo to auto")):
        with pty_chip(echo=echo) as chip:
            port = port_to(chip, echo=cast("Echo", say))
            with pytest.raises(BadReply, match=hint):
                await word(port, XACTUAL)
            await port.aclose()
    for echo, say in ((True, "on"), (False, "off")):
        async with line(echo=echo, say=cast("Echo", say)) as (_, port):
            await write(port, (VMAX, 9))
            assert await word(port, VMAX) == 9


@pytest.mark.parametrize("frame", [READ, NODE.write(VMAX, 0x0102_0304)], ids=["read", "write"])
async def test_an_echo_that_differs_is_not_taken_off(frame: bytes) -> None:
    """The wire is disturbed, or another master talked at the same moment: then nobody knows what the chip heard."""
    async with line(echo=True) as (chip, port):
        await write(port, (AMAX, 1))

        def disturbed(module: PtyModule, heard: bytes) -> bytes:
            if heard != frame:
                return right(module, heard)
            module.behave = right
            spoilt = bytes((heard[0] ^ 0x10,)) + heard[1:]
            return spoilt + chip.obey(heard)

        chip.behave = disturbed
        with pytest.raises(BadReply, match="the echo differs"):
            await port.exchange(frame)
        assert kinds(port)[-1] == "mismatch"
        assert await word(port, XACTUAL) == word_of(XACTUAL, 0)


async def test_an_echo_and_an_answer_may_come_in_any_pieces() -> None:
    """As adapters pass them on: byte by byte, or part of one with part of the other."""
    async with line(echo=True) as (chip, port):
        for cut in range(1, 12):

            def in_pieces(module: PtyModule, frame: bytes, cut: int = cut) -> bytes:
                said = right(module, frame)
                module.say(said[:cut])
                threading.Event().wait(0.002)
                return said[cut:]

            chip.behave = in_pieces
            assert await word(port, XACTUAL) == word_of(XACTUAL, 0)
            await write(port, (VMAX, cut))
        assert kinds(port) == ["opened"]


async def test_a_chip_without_power_on_a_wire_with_an_echo_is_told() -> None:
    with pty_chip(echo=True, behave=lambda module, frame: frame) as chip:
        port = port_to(chip, 5, timeout_s=SHORT_S)
        with pytest.raises(LinkTimeout, match="node 5, asked for register 0x02 first; only its echo came"):
            await word(port, XACTUAL)
        await port.aclose()


async def test_an_echo_that_vanishes_or_begins_is_noticed() -> None:
    async with line(echo=True) as (chip, port):
        chip.echo = False
        with pytest.raises(LinkError):
            await word(port, XACTUAL, SHORT_S)
        assert await word(port, XACTUAL) == word_of(XACTUAL, 0)
        chip.echo = True
        with pytest.raises(BadReply, match="this line has an echo now"):
            await word(port, XACTUAL)
        assert await word(port, XACTUAL) == word_of(XACTUAL, 0)


# --- staying in step ----------------------------------------------------------------------------


async def test_a_line_is_in_step_before_the_first_question() -> None:
    with pty_chip() as chip:
        chip.say(NODE.reply(XACTUAL, 111) + b"\x05\xff")
        port = port_to(chip)
        assert await word(port, XACTUAL) == word_of(XACTUAL, 0)
        assert chip.seen == [NODE.read(IFCNT), READ]
        await port.aclose()


async def test_a_late_answer_is_not_taken_for_the_next_one() -> None:
    """Same register, same length, right CRC: only its place in time tells."""
    async with line() as (chip, port):
        chip.behave = silent
        with pytest.raises(LinkTimeout) as caught:
            await word(port, XACTUAL, SHORT_S)
        assert caught.value.waited_s == SHORT_S

        def first_the_old(module: PtyModule, frame: bytes) -> bytes:
            module.behave = right
            return NODE.reply(XACTUAL, 111) + right(module, frame)

        chip.behave = first_the_old
        assert await word(port, XACTUAL) == word_of(XACTUAL, 0)
        assert kinds(port) == ["opened", "timeout", "resync"]


async def test_fences_are_registers_that_nobody_owes() -> None:
    async with line() as (chip, port):
        chip.behave = silent
        chip.seen.clear()
        for _ in range(4):
            with pytest.raises(LinkTimeout):
                await word(port, IFCNT, SHORT_S)
        await until(lambda: len(chip.seen) >= 4)  # the peer is a thread, and the time limits are short
        asked = [NODE.register_of(frame) for frame in chip.seen]
        assert len(set(asked)) == len(asked) == 4
        assert READ not in chip.seen
        chip.behave = right
        assert await word(port, XACTUAL) == word_of(XACTUAL, 0)


@pytest.mark.parametrize(
    ("damage", "kind"),
    [
        (lambda reply: reply[:5], "short"),
        (lambda reply: reply[:4] + bytes((reply[4] ^ 1,)) + reply[5:], "checksum"),
        (lambda reply: NODE.reply(XTARGET, 1), "mismatch"),
        (lambda reply: reply + b"\x05", "foreign"),
        (lambda reply: reply + reply, "foreign"),
    ],
    ids=["short", "flipped", "another register", "a byte more", "twice"],
)
async def test_a_wrong_answer_is_told_and_got_over(damage: object, kind: IncidentKind) -> None:
    async with line() as (chip, port):
        assert callable(damage)
        chip.behave = but_fences(lambda module, frame: damage(right(module, frame)))
        with pytest.raises(BadReply):
            await word(port, XACTUAL, PART_S if kind == "short" else None)
        assert kinds(port)[-1] == kind
        chip.behave = right
        assert await word(port, XACTUAL) == word_of(XACTUAL, 0)
        assert kinds(port)[-1] == "resync"


async def test_bytes_that_nobody_asked_for_mean_another_master() -> None:
    async with line() as (chip, port):
        chip.say(NODE.read(VMAX) + NODE.reply(VMAX, 1))
        await until(lambda: kinds(port)[-1] == "foreign")
        with pytest.raises(BadReply, match="another master talks on the line"):
            await word(port, XACTUAL)
        assert await word(port, XACTUAL) == word_of(XACTUAL, 0)


@pytest.mark.parametrize("stop", [(VMAX, 0), (0x47, 0)])
async def test_a_stop_goes_out_at_once_also_when_out_of_step(stop: tuple[int, int]) -> None:
    async with line() as (chip, port):
        chip.behave = silent
        with pytest.raises(LinkTimeout):
            await word(port, XACTUAL, SHORT_S)
        chip.seen.clear()
        chip.behave = right
        await port.exchange(NODE.write(*stop))
        assert chip.seen[0] == NODE.write(*stop)
        assert chip.words[0, stop[0]] == stop[1]
        chip.behave = silent
        for _ in range(2):
            chip.seen.clear()
            with pytest.raises(LinkTimeout):
                await port.exchange(NODE.write(*stop), SHORT_S)
            assert chip.seen[0] == NODE.write(*stop), "even where nothing is answered"


async def test_another_write_waits_until_the_chip_answers() -> None:
    with pty_chip(behave=silent) as chip:
        port = port_to(chip)
        with pytest.raises(LinkTimeout, match="was not sent"):
            await port.exchange(NODE.write(VMAX, 5), SHORT_S)
        assert NODE.write(VMAX, 5) not in chip.seen
        await port.aclose()


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_whatever_happens_on_the_wire_no_wrong_word_is_believed(seed: int) -> None:
    """Silence, pieces, flipped bits, answers twice and to something else, in any order; and in the end all is well."""

    async def run() -> None:
        chance = random.Random(seed)

        def bad(module: PtyModule, frame: bytes) -> bytes:
            said = right(module, frame)
            if not said or chance.random() < 0.6:
                return said
            at = chance.randrange(len(said))
            flipped = said[:at] + bytes((said[at] ^ 1 << chance.randrange(8),)) + said[at + 1 :]
            return chance.choice([b"", said[:at], flipped, said + said, chance.randbytes(at), said + said[:at]])

        async with line(echo=bool(seed & 1)) as (chip, port):
            chip.behave = bad
            written = -1
            for number in range(12):
                with contextlib.suppress(LinkError):
                    assert await word(port, XACTUAL, 0.02) == word_of(XACTUAL, 0)
                with contextlib.suppress(LinkError):
                    await port.exchange(NODE.write(VMAX, number), 0.02)
                    written = number
                    assert chip.words[0, VMAX] == number
            chip.behave = right
            for _ in range(3):
                with contextlib.suppress(LinkError):
                    await word(port, XACTUAL)
            assert await word(port, XACTUAL) == word_of(XACTUAL, 0)
            assert written < 0 or chip.words[0, VMAX] >= written

    asyncio.run(run())


# --- several on one line ------------------------------------------------------------------------


async def test_two_chips_take_turns_on_one_line() -> None:
    with pty_chip((1, 2)) as chip:
        ports = [port_to(chip, node) for node in (1, 2)]
        assert ports[0].arbiter is ports[1].arbiter
        assert ports[0].wire is ports[1].wire
        queues = [LinkQueue(port) for port in ports]
        accesses = [UartAccess(form=port.form) for port in ports]

        async def ask(which: int) -> list[int]:
            frames = accesses[which].read_frames([XACTUAL, VMAX, XTARGET])
            return accesses[which].words(await queues[which].exchange_many(frames))

        for which, words in enumerate(await asyncio.gather(ask(0), ask(1))):
            assert words == [word_of(register, which + 1) for register in (XACTUAL, VMAX, XTARGET)]
        await write(ports[0], (AMAX, 5))
        await write(ports[1], (AMAX, 6))
        await write(ports[0], (AMAX, 7))
        assert (chip.words[1, AMAX], chip.words[2, AMAX]) == (7, 6)
        await ports[0].aclose()
        assert await word(ports[1], AMAX) == 6, "the line stays open for the other"
        await ports[1].aclose()


async def test_a_silent_chip_does_not_keep_the_other_from_answering() -> None:
    with pty_chip((2,)) as chip:
        gone, there = port_to(chip, 1), port_to(chip, 2)
        for _ in range(2):
            with pytest.raises(LinkTimeout):
                await word(gone, XACTUAL, SHORT_S)
            assert await word(there, XACTUAL) == word_of(XACTUAL, 2)
        for port in (gone, there):
            await port.aclose()


async def test_a_stop_comes_between_the_writes_of_somebody_else_and_no_count_is_wrong() -> None:
    async with line() as (chip, port):
        queue = LinkQueue(port)
        access = UartAccess()
        frames = access.write_frames([(AMAX, value) for value in range(200)])
        writing = asyncio.create_task(queue.exchange_many(frames))
        await until(lambda: chip.words.get((0, AMAX), 0) > 3)
        await queue.exchange(access.write_frame(VMAX, 0), Priority.STOP)
        assert chip.words[0, AMAX] < 199, "it did not wait for the end of them"
        replies = await writing
        access.check_all(frames, replies)
        assert chip.words[0, AMAX] == 199
        assert kinds(port) == ["opened"]


async def test_all_on_a_line_say_the_same_of_it() -> None:
    with pty_chip((1,)) as chip:
        first = port_to(chip, 1)
        await word(first, XACTUAL)
        for other, why in (
            (port_to(chip, 2, echo="on"), "open with echo auto"),
            (port_to(chip, None), "chips without a node"),
            (port_to(chip, 2, baud=9600), "115200 baud"),
        ):
            with pytest.raises(LinkDown, match=why):
                await word(other, XACTUAL)
        with pytest.raises(LinkDown, match=r"open already as uart .*"):
            await serial_port(chip.path).exchange(bytes(9))
        await first.aclose()
        await settle()


# --- options ------------------------------------------------------------------------------------


def made(model: str, **options: object) -> UartPort:
    return cast("UartPort", uart_factory(model, {"kind": "uart", **options}, VirtualClock()))


def test_options() -> None:
    port = made("tmc5160", port="/dev/ttyUSB0")
    assert (port.name, port.baud, port.echo) == ("uart /dev/ttyUSB0, node 0", 115_200, "auto")
    assert port.wire.calls_per_s_possible == pytest.approx(115_200 / 130), "4 bytes, 8 bit times, 8 bytes"
    assert made("tmc5072", port="socket://h:1", node=9).baud is None
    plain = made("tmc5062", port="/dev/ttyUSB0", baud=9600)
    assert (plain.name, plain.form.node) == ("uart /dev/ttyUSB0", None)


@pytest.mark.parametrize(
    ("model", "options", "error"),
    [
        ("tmc5031", {"port": "x"}, UsageError),
        ("tmc4361", {"port": "x"}, UsageError),
        ("tmc5160", {}, UsageError),
        ("tmc5160", {"port": "x", "node": 255}, OutOfRange),
        ("tmc5160", {"port": "x", "baud": 8999}, OutOfRange),
        ("tmc5160", {"port": "x", "echo": "maybe"}, UsageError),
        ("tmc5160", {"port": "x", "address": 1}, UnknownThing),
        ("tmc5062", {"port": "x", "node": 0}, UsageError),
    ],
)
def test_options_that_cannot_be(model: str, options: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error):
        made(model, **options)
