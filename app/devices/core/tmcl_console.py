"""TMCL commands as a user sends them by hand: which are never sent, and what an exchange comes to, in words."""

from __future__ import annotations

from typing import Protocol

from ...errors import OutOfRange, WrongState
from ...links.tmcl import FRAME_BYTES, Reply, Request, has_plain_reply, sound, version_string
from ...registers.tmcl.commands import BY_OPCODE, Opcode
from .capabilities import RawFrames, TmclCommands
from .results import RawExchange, TmclExchange
from .session import Session
from .tmcl_frames import request_of, spelled
from .tmcl_link import TmclLink

STOPPING = frozenset({Opcode.MST, Opcode.STOP_APPLICATION, Opcode.RESET_APPLICATION, Opcode.FACTORY_DEFAULT})
"""Commands that stop a motor, or the program that may turn it."""
BOOT_LOADER = frozenset({*range(200, 209), Opcode.BOOT})
"""Commands that start the boot loader or are its own: it erases and writes the firmware."""
UNANSWERED_S = 0.1
"""How long an answer is waited for that need not come [s]."""


def require_no_boot_loader(request: Request) -> None:
    """Raises WrongState for a command that would end the firmware."""
    if request.opcode in BOOT_LOADER:
        raise WrongState(
            f"command {request.opcode} belongs to the boot loader: it ends the firmware, and with it every way to "
            "stop the motor",
            "update the firmware with the maker's TMCL-IDE, while this device is disconnected here",
        )


def exchange_of(request: Request, frame: bytes, reply: bytes, took_ms: float) -> TmclExchange:
    """A command and its answer, b"" where there was none."""
    said = spelled(request)
    if not reply:
        return TmclExchange(frame, None, None, "not answered", None, f"{said} -> not answered", took_ms)
    if request.opcode == Opcode.GET_VERSION and request.type == 0 and len(reply) == FRAME_BYTES:
        text = version_string(reply)
        return TmclExchange(frame, reply, None, "text", None, f"{said} -> {text}", took_ms)
    if not has_plain_reply(frame) or len(reply) != FRAME_BYTES:
        return TmclExchange(frame, reply, None, "data", None, f"{said} -> {reply.hex(' ')}", took_ms)
    if not sound(reply):
        return TmclExchange(
            frame, reply, None, "wrong checksum in the answer", None, f"{said} -> garbled answer", took_ms
        )
    answer = Reply.decode(reply)
    shown = str(answer.value) if answer.ok else f"status {answer.status}, {answer.status_text}"
    return TmclExchange(frame, reply, answer.status, answer.status_text, answer.value, f"{said} -> {shown}", took_ms)


def raw_exchange_of(request: Request, frame: bytes, reply: bytes, took_ms: float) -> RawExchange:
    """The same with its parts by name."""
    done = exchange_of(request, frame, reply, took_ms)
    row = BY_OPCODE.get(request.opcode)
    return RawExchange(
        reply,
        {
            "address": request.address,
            "command": request.opcode,
            "mnemonic": None if row is None else row.mnemonic or row.name,
            "type": request.type,
            "motor": request.motor,
            "request_value": request.value,
            "status": done.status,
            "status_text": done.status_text,
            "value": done.value,
            "text": done.text,
        },
    )


class Sender(Protocol):
    """Sends what a user asks for by hand, once, and knows what it may set in motion."""

    async def send(self, request: Request, frame: bytes) -> tuple[bytes, float]:
        """The raw answer, b"" where there is none and need not be, and how long it took [ms]."""
        ...


class Console(RawFrames, TmclCommands):
    """Sends any command to the module of `link`."""

    def __init__(self, session: Session, link: TmclLink, sender: Sender) -> None:
        self._session = session
        self._link = link
        self._sender = sender

    async def tmcl(
        self,
        command: int | str,
        type: int | str = 0,  # noqa: A002 (TMCL's own word)
        motor: int = 0,
        value: int = 0,
    ) -> TmclExchange:
        """One direct command; `command` and `type` by number or by TMCL's names. Never sent twice.

        A status of an error is an answer, not an exception. Raises UnknownThing for a name, OutOfRange
        for a number that its field cannot hold, LinkError.
        """
        request = request_of(self._link.address, command, type, motor, value)
        self._session.require_connected()
        frame = request.encode()
        return exchange_of(request, frame, *await self._sender.send(request, frame))

    async def exchange(self, frame: bytes) -> RawExchange:
        """Nine bytes as they are, even with a wrong checksum or another module's address."""
        if len(frame) != FRAME_BYTES:
            raise OutOfRange("frame length", len(frame), FRAME_BYTES, FRAME_BYTES, "bytes")
        self._session.require_connected()
        request = Request.decode(frame)
        return raw_exchange_of(request, frame, *await self._sender.send(request, frame))
