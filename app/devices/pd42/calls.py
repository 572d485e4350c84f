"""Commands within one turn of the link: answers checked, statuses judged, reads asked again."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from app.devices.pd42.frames import reading, spelled, writing
from app.devices.pd42.refusals import refusal, uncertain
from app.links.errors import BadReply, LinkError, LinkTimeout
from app.links.queue import Turn
from app.links.tmcl import Reply, Request, check_reply, is_retriable
from app.registers.model import Register
from app.registers.tmcl import Status

ASKED_AGAIN = 2
"""How often a read is asked again: the link is in step again before each, and a read moves nothing."""


class Calls:
    """One module's commands in one turn. `saw` hears each value that was read or taken."""

    def __init__(self, turn: Turn, link: str, address: int, saw: Callable[[Register, int], None]) -> None:
        self._turn = turn
        self._link = link
        self._saw = saw
        self.address = address
        self.unit_mode: int | None = None

    @property
    def time_s(self) -> float:
        """When the latest command was answered, device time [s]."""
        return self._turn.last_exchange_s

    async def reply(self, request: Request) -> Reply:
        """The checked answer, whatever its status but a wrong checksum. Raises LinkError; reads are asked again."""
        frame = request.encode()
        again = ASKED_AGAIN if is_retriable(frame) else 0
        while True:
            try:
                return self._checked(frame, await self._turn.exchange(frame))
            except (BadReply, LinkTimeout):
                if not again:
                    raise
                again -= 1

    async def do(self, request: Request, register: Register | None = None) -> Reply:
        """The answer to a command that was done. Raises LinkError, and by status UsageError."""
        reply = await self.reply(request)
        if reply.status != Status.OK:
            raise refusal(request, reply, register, self.unit_mode)
        return reply

    async def move(self, request: Request, what: str, register: Register | None = None) -> Reply:
        """As `do`, for what may move a motor: sent once, and a failure says that its effect is not known."""
        try:
            return await self.do(request, register)
        except LinkError as error:
            raise uncertain(error, what) from error

    async def get(self, register: Register) -> int:
        """The value of a row."""
        reply = await self.do(reading(self.address, register), register)
        return self._value(register, reply)

    async def put(self, register: Register, value: int) -> None:
        """Write a row that moves nothing. It is not read back here."""
        await self.do(writing(self.address, register, value), register)

    async def get_many(self, registers: Sequence[Register]) -> list[int]:
        """The values of several rows, in few steps over the link; as one row after the other where that fails."""
        requests = [reading(self.address, register) for register in registers]
        frames = [request.encode() for request in requests]
        if not all(is_retriable(frame) for frame in frames):
            return [await self.get(register) for register in registers]
        try:
            answers = await self._turn.exchange_many(frames)
        except (BadReply, LinkTimeout):
            return [await self.get(register) for register in registers]
        values = []
        for register, request, frame, answer in zip(registers, requests, frames, answers, strict=True):
            try:
                reply = self._checked(frame, answer)
            except BadReply:
                values.append(await self.get(register))
                continue
            if reply.status != Status.OK:
                raise refusal(request, reply, register, self.unit_mode)
            values.append(self._value(register, reply))
        return values

    def _checked(self, frame: bytes, answer: bytes) -> Reply:
        reply = check_reply(self._link, frame, answer)
        if reply.status == Status.WRONG_CHECKSUM:
            raise BadReply(self._link, f"{spelled(Request.decode(frame))} arrived garbled and was not done", answer)
        return reply

    def _value(self, register: Register, reply: Reply) -> int:
        value = register.decode(reply.value)
        self._saw(register, value)
        return value
