"""Commands as they are: nine raw bytes, or one TMCL command by its fields. What they may set in motion is known."""

from __future__ import annotations

import time

from ...errors import BadReply, LinkError, OutOfRange, UnknownThing, WrongState
from ...links.port import Answer
from ...links.queue import Priority
from ...links.tmcl import (
    FRAME_BYTES,
    Reply,
    Request,
    as_value,
    check_reply,
    has_plain_reply,
    has_reply,
    sound,
    version_string,
)
from ...registers.model import Register, Space, to_raw
from ...registers.tmcl.commands import BY_MNEMONIC, BY_OPCODE, CONTROL_FIRST, Opcode, Status
from ..core.changes import BY_HAND, register_changed
from ..core.results import RawExchange, TmclExchange
from . import rows
from .frames import spelled, written_by
from .parameters import Parameters

STOPPING = frozenset({Opcode.MST, Opcode.STOP_APPLICATION, Opcode.RESET_APPLICATION, Opcode.FACTORY_DEFAULT})
"""Commands that stop a motor, or the program that may turn it."""
BOOT_LOADER = frozenset({*range(200, 209), Opcode.BOOT})
"""Commands that start the boot loader or are its own: it erases and writes the firmware."""
UNANSWERED_S = 0.1
"""How long an answer is waited for that need not come [s]."""


class Console(Parameters):
    """A TMCL module that takes any command."""

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
        request = self._spelled_out(command, type, motor, value)
        self.require_connected()
        frame = request.encode()
        reply, took_ms = await self._exchange(request, frame)
        return _exchange_of(request, frame, reply, took_ms)

    async def exchange(self, frame: bytes) -> RawExchange:
        """Nine bytes as they are, even with a wrong checksum or another module's address."""
        if len(frame) != FRAME_BYTES:
            raise OutOfRange("frame length", len(frame), FRAME_BYTES, FRAME_BYTES, "bytes")
        self.require_connected()
        request = Request.decode(frame)
        answer, took_ms = await self._exchange(request, frame)
        done = _exchange_of(request, frame, answer, took_ms)
        row = BY_OPCODE.get(request.opcode)
        return RawExchange(
            answer,
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

    def _spelled_out(self, command: int | str, type_: int | str, motor: int, value: int) -> Request:
        if isinstance(command, str):
            row = BY_MNEMONIC.get(command.strip().upper())
            if row is None:
                raise UnknownThing("TMCL command", command, list(BY_MNEMONIC))
        else:
            row = BY_OPCODE.get(command)
        if isinstance(type_, str):
            names = {} if row is None else row.types
            code = names.get(type_.strip().upper())
            if code is None:
                what = f"type of {command}" if row is None else f"type of {row.mnemonic or row.name}"
                raise UnknownThing(what, type_, list(names))
            type_ = code
        opcode = row.opcode if isinstance(command, str) and row is not None else command
        assert isinstance(opcode, int)
        for name, number in (("command", opcode), ("type", type_), ("motor", motor)):
            if not 0 <= number <= 255:
                raise OutOfRange(name, number, 0, 255, "one byte")
        try:
            return Request(self.address, opcode, type_, motor, as_value(value))
        except ValueError as error:
            raise OutOfRange("value", value, -(1 << 31), (1 << 32) - 1, "32 bits") from error

    async def _exchange(self, request: Request, frame: bytes) -> tuple[bytes, float]:
        """The raw answer, b"" where there is none and need not be, and how long it took [ms]."""
        self._require_harmless(request)
        stored = request.opcode < CONTROL_FIRST and self.download.problem is not None
        moves = request.address == self.address and not stored and _may_move(request)
        if not stored:
            await self._learn(request)
        self._allow(request)
        if moves:
            # Told before it goes out: whatever runs on this axis has to let go of it first.
            self.commanded(0, spelled(request))
        answer = Answer.ALWAYS
        if not has_reply(frame) or request.address != self.address:
            answer = Answer.MAYBE
        began = time.perf_counter()
        guard = self.stop_guard([0]) if moves and request.opcode not in STOPPING else None
        async with self.queue.turn(Priority.COMMAND, guard, by_hand=True) as turn:
            try:
                reply = await turn.exchange(frame, UNANSWERED_S if answer is Answer.MAYBE else None, answer)
            except LinkError as error:
                if moves:
                    self._motion_uncertain(str(error))
                raise
        took_ms = (time.perf_counter() - began) * 1e3
        if reply:
            self._saw_exchange(request, frame, reply)
        if moves and self.download.problem is None:
            await self._moved_by_hand(request)
        return reply, took_ms

    def _require_harmless(self, request: Request) -> None:
        """Raises WrongState for a command after which the module could not be driven, or its motor not be seen."""
        if request.opcode in BOOT_LOADER:
            raise WrongState(
                f"command {request.opcode} belongs to the boot loader: it ends the firmware, and with it every way to "
                "stop the motor",
                "update the firmware with the maker's TMCL-IDE, while this device is disconnected here",
            )
        if request.opcode == Opcode.ENTER_DOWNLOAD and request.address == self.address and self._moves():
            raise WrongState(
                "the motor moves, and in download mode nobody could look at it",
                "stop it, then enter download mode",
            )

    def _moves(self) -> bool:
        """Whether a motion is under way, as far as this driver knows."""
        raise NotImplementedError

    async def _learn(self, request: Request) -> None:
        """Read what a command counts from, where soft limits have to know it."""
        if self.limiter is not None and request.address == self.address:
            await self.limiter.rules.learn_for(request.opcode, request.type, request.value)

    def _allow(self, request: Request) -> None:
        """Raises SoftLimit before anybody is told of a command that will not go out."""
        if self.limiter is not None:
            self.limiter.check((request.encode(),))

    def _saw_exchange(self, request: Request, frame: bytes, reply: bytes) -> None:
        """What was read or written by hand is known from now on."""
        place = (Space.AXIS, request.type) if request.opcode == Opcode.GAP else written_by(request)
        if place is None or not sound(reply):
            return
        try:
            answer = check_reply(self.port.name, frame, reply)
        except BadReply:
            return
        space, number = place
        register = self.table.at(number, space)
        if answer.status != Status.OK or register is None or (space is Space.AXIS and request.motor != register.axis):
            return
        if request.opcode == Opcode.GAP:
            self._saw(register, register.decode(answer.value))
            return
        old = self._known.get(register.address) if space is Space.AXIS else None
        bits = None if old is None else to_raw(old, register.width)
        new = to_raw(request.value, register.width)
        self._tell(register_changed(register, bits, new, self.port.last_exchange_s, BY_HAND))
        if space is Space.AXIS:
            self._wrote_by_hand(register)

    def _wrote_by_hand(self, register: Register) -> None:
        """A parameter was written: what it holds now only a read tells."""
        self._known.pop(register.address, None)

    def _motion_uncertain(self, why: str) -> None:
        """A command that may have moved or stopped the motor failed: what the axis does is not known."""
        raise NotImplementedError

    async def _moved_by_hand(self, request: Request) -> None:
        """A command that may move or stop the motor was answered."""
        raise NotImplementedError


def _may_move(request: Request) -> bool:
    """Whether the command may set a motor in motion or stop it."""
    if request.opcode in STOPPING:
        return True
    if request.opcode in (Opcode.SAP, Opcode.AAP):
        return request.type in {row.address for row in rows.MOVING}
    if request.opcode == Opcode.RFS:
        return request.type != 2
    row = BY_OPCODE.get(request.opcode)
    return row is None or row.moves


def _exchange_of(request: Request, frame: bytes, reply: bytes, took_ms: float) -> TmclExchange:
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
