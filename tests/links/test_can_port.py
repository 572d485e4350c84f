"""TMCL over python-can's virtual bus: seven bytes there, seven bytes back, and the identifiers say who."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import can
import pytest

from app.clock import VirtualClock
from app.errors import BadReply, LinkDown, LinkTimeout, OutOfRange, UnknownThing, UsageError
from app.links import can_bus
from app.links.can_line import CanPort, can_port
from app.links.queue import LinkQueue
from app.links.registry import can_factory
from app.links.tmcl import Reply, Request, version_string
from tests.links.pty_module import LONG_S, answer, gap, until, value_of

SHORT_S = 0.03


class CanModule:
    """A module on the bus. `behave` says what comes back for a message: bytes of the answer, or None."""

    def __init__(self, channel: str, listens: int = 1, answers: int = 2) -> None:
        self.behave: Callable[[bytes], bytes | None] = self.right
        self.listens, self.answers = listens, answers
        self.seen: list[can.Message] = []
        self._bus = can.Bus(interface="virtual", channel=channel)
        self._over = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def right(self, data: bytes) -> bytes | None:
        frame = bytes((self.listens & 0xFF, *data[:7], 0))
        reply = answer(frame)
        return reply[1:] if data[:2] == b"\x88\x00" else reply[1:8]

    def say(self, data: bytes, identifier: int | None = None) -> None:
        identifier = self.answers if identifier is None else identifier
        self._bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))

    def _run(self) -> None:
        while not self._over:
            message = self._bus.recv(0.02)
            if message is not None and message.arbitration_id == self.listens:
                self.seen.append(message)
                reply = self.behave(bytes(message.data))
                if reply is not None:
                    self.say(reply)

    def close(self) -> None:
        self._over = True
        self._thread.join(5)
        self._bus.shutdown()


@contextmanager
def can_module(channel: str, listens: int = 1, answers: int = 2) -> Iterator[CanModule]:
    module = CanModule(channel, listens, answers)
    try:
        yield module
    finally:
        module.close()


def port_on(channel: str, send_id: int = 1, receive_id: int = 2) -> CanPort:
    return can_port("virtual", channel, bitrate=1_000_000, send_id=send_id, receive_id=receive_id, timeout_s=LONG_S)


async def value(port: CanPort, number: int, address: int = 1) -> int:
    return Reply.decode(await port.exchange(gap(number, address))).value


async def test_seven_bytes_there_and_back(request: pytest.FixtureRequest) -> None:
    with can_module(request.node.name) as module:
        port = port_on(request.node.name)
        assert await value(port, 1) == value_of(1)
        assert [bytes(message.data).hex(" ") for message in module.seen] == [
            "88 01 00 00 00 00 00",  # in step first
            "06 01 00 00 00 00 00",
        ]
        assert not any(message.is_extended_id for message in module.seen)
        replies = await LinkQueue(port).exchange_many([gap(n) for n in range(50)])
        assert [Reply.decode(reply).value for reply in replies] == [value_of(n) for n in range(50)]
        assert port.wire.calls_per_s_possible is None
        await port.aclose()


async def test_the_version_as_a_string_takes_eight_bytes(request: pytest.FixtureRequest) -> None:
    with can_module(request.node.name) as module:
        port = port_on(request.node.name)
        reply = await port.exchange(Request(1, 136, 0).encode())
        assert version_string(reply) == "1241V144"
        assert len(module.seen[-1].data) == 8
        await port.aclose()


async def test_several_modules_on_a_bus_are_told_apart_by_their_identifiers(request: pytest.FixtureRequest) -> None:
    name = request.node.name
    with can_module(name, 1, 2) as _, can_module(name, 0x123, 0x223) as _:
        one, two = port_on(name), port_on(name, 0x123, 0x223)
        assert one.arbiter is two.arbiter
        assert await value(one, 5) == value_of(5)
        assert await value(two, 5, address=0x23) == value_of(5, 0x23)
        # Frames may bear any address: who is meant is a matter of identifiers, and the answer fits the question.
        assert Reply.decode(await two.exchange(gap(5, 1))).module == 1
        await one.aclose()
        await two.aclose()


async def test_two_modules_that_cannot_be_told_apart(request: pytest.FixtureRequest) -> None:
    name = request.node.name
    with can_module(name):
        one, same = port_on(name), port_on(name, 0x101, 5)
        await value(one, 1)
        with pytest.raises(LinkDown, match="cannot be told from"):
            await same.exchange(gap(1))
        await one.aclose()
        await same.aclose()


async def test_other_traffic_and_events(request: pytest.FixtureRequest) -> None:
    with can_module(request.node.name) as module:
        port = port_on(request.node.name)
        heard: list[bytes] = []
        port.on_event(heard.append)
        await value(port, 1)
        module.say(b"\x01\x02\x03", 0x300)  # another protocol on the same bus
        module.say(bytes.fromhex("01808a00000001"))
        await until(lambda: len(heard) == 1)
        assert heard == [bytes.fromhex("0201808a000000010e")]
        assert await value(port, 2) == value_of(2)
        assert [incident.kind for incident in port.incidents.list()] == ["opened"]
        await port.aclose()


async def test_silence_and_wrong_answers(request: pytest.FixtureRequest) -> None:
    with can_module(request.node.name) as module:
        port = port_on(request.node.name)
        await value(port, 1)
        module.behave = lambda data: None
        with pytest.raises(LinkTimeout):
            await port.exchange(gap(1), SHORT_S)
        module.behave = module.right
        module.say(answer(gap(1))[1:8])  # too late
        assert await value(port, 2) == value_of(2)
        module.behave = lambda data: answer(Request(1, 5, 4).encode())[1:8]
        with pytest.raises(BadReply):
            await port.exchange(gap(1))
        await port.aclose()


async def test_an_interface_that_is_not_there() -> None:
    port = can_port("socketcan", "stepscope-none", bitrate=500_000, send_id=1, receive_id=2)
    with pytest.raises(LinkDown):
        await port.exchange(gap(1))
    await port.aclose()


def test_without_python_can(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(can_bus, "find_spec", lambda name: None)
    with pytest.raises(UsageError, match=r"stepscope\[can\]"):
        port_on("x")


@pytest.mark.parametrize(
    ("link", "error"),
    [
        ({}, UsageError),
        ({"interface": "virtual"}, UsageError),
        ({"interface": "virtual", "channel": "x", "bitrate": 5}, OutOfRange),
        ({"interface": "virtual", "channel": "x", "send_id": 0x800}, OutOfRange),
        ({"interface": "virtual", "channel": "x", "receive_id": True}, OutOfRange),
        ({"interface": "virtual", "channel": "x", "send_id": 2}, UsageError),
        ({"interface": "virtual", "channel": "x", "timeout_s": 0}, OutOfRange),
        ({"interface": "virtual", "channel": "x", "address": 1}, UnknownThing),
    ],
)
def test_options_that_cannot_be(link: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error):
        can_factory("pd42-1241", {"kind": "can", **link}, VirtualClock())
    with pytest.raises(UsageError, match="has no can link"):
        can_factory("tmc428", {"kind": "can", "interface": "virtual", "channel": "x"}, VirtualClock())
