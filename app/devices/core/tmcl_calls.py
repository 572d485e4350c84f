"""Commands within one turn of the link: answers checked, statuses judged, reads asked again."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from ...errors import BadReply, LinkError, LinkTimeout, UnknownParameter
from ...links.queue import Turn
from ...links.tmcl import Reply, Request, check_reply, is_retriable
from ...registers.model import Register, Space
from ...registers.tmcl.commands import Status
from .tmcl_frames import reading, spelled, writing
from .tmcl_refusals import refusal, uncertain

ASKED_AGAIN = 2
"""How often a read is asked again: the link is in step again before each, and a read moves nothing."""


Key = tuple[Space, int]


class Lacking:
    """Rows that one module does not have: by its table, or by its answers where its firmware is another version."""

    def __init__(self, absent: Iterable[Register] = (), instead: Mapping[Key, Register] | None = None) -> None:
        """`absent` are those that its table lacks, `instead` says which row tells the same as another."""
        self._absent = frozenset((row.space, row.address) for row in absent)
        self._instead = instead or {}
        self._rows: dict[Key, Register] = {}

    @property
    def rows(self) -> list[Register]:
        """Those that it has answered not to have, in the order of their numbers."""
        return [self._rows[key] for key in sorted(self._rows)]

    def has(self, register: Register) -> bool:
        """Whether `register` is one of them."""
        key = (register.space, register.address)
        return key in self._absent or key in self._rows

    def instead(self, register: Register) -> Register | None:
        """Another row that says the same as `register`."""
        return self._instead.get((register.space, register.address))

    def add(self, register: Register) -> None:
        """The module has just said so."""
        self._rows[register.space, register.address] = register

    def clear(self) -> None:
        """It may be another module, or the same with another firmware."""
        self._rows.clear()


class Calls:
    """One module's commands in one turn. `saw` hears each value that was read or taken."""

    def __init__(
        self,
        turn: Turn,
        link: str,
        address: int,
        saw: Callable[[Register, int], None],
        lacking: Lacking,
    ) -> None:
        self._turn = turn
        self._link = link
        self._saw = saw
        self._lacking = lacking
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
        """The value of a row. Raises UnknownParameter where the module has none of that number."""
        try:
            reply = await self.do(reading(self.address, register), register)
        except UnknownParameter:
            self._lacking.add(register)
            raise
        return self._value(register, reply)

    async def ask_many(self, registers: Sequence[Register]) -> list[int | None]:
        """As `get_many`, with None for rows that this module does not have; those are asked for once only.

        Where another row says the same (`Lacking.instead`), that is read in place of one that is lacking.
        """
        asked = [self._asked(register) for register in registers]
        try:
            found = iter(await self.get_many([row for row in asked if row is not None]))
            values = [None if row is None else next(found) for row in asked]
        except UnknownParameter:
            values = [await self._ask(register) for register in registers]
        for register, row, value in zip(registers, asked, values, strict=True):
            if row is not register and value is not None:
                self._saw(register, value)
        return values

    def _asked(self, register: Register) -> Register | None:
        """The row to read for `register`: that one, or another that says the same; None where the module has none."""
        either = (register, self._lacking.instead(register))
        return next((row for row in either if row is not None and not self._lacking.has(row)), None)

    async def _ask(self, register: Register) -> int | None:
        while (row := self._asked(register)) is not None:  # each turn of this one row is found to be lacking
            try:
                return await self.get(row)
            except UnknownParameter:
                continue
        return None

    async def before(self, register: Register) -> int | None:
        """What the module holds before a write, where it can be asked and clears nothing by it."""
        if not register.access.readable or register.read_clears:
            return None
        try:
            return await self.get(register)
        except UnknownParameter:  # the table knows more than this firmware: the write itself will tell
            return None

    def need(self, register: Register, value: int | None) -> int:
        """`value` of `ask_many`, where nothing goes on without it. Raises UnknownParameter."""
        if value is None:
            request = reading(self.address, register)
            raise refusal(request, Reply(0, self.address, Status.WRONG_TYPE, request.opcode), register)
        return value

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
            if reply.status == Status.WRONG_TYPE:
                values.append(await self.get(register))  # raises, and keeps it in mind
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
