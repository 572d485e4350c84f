"""The program memory of a module: assembled, stored, read back, run and looked at (FM-PD42-1241 3.6.36).

A command whose answer is lost may be stored or not; so the download is entered again at the very address, where
storing the same command twice makes no difference. A command goes out only after the module has confirmed that it
stores, and an answer that says "done" instead of "stored" ends the download at once. Memory is read back after the end:
the answers of command 134 have no checksum, so what differs is read again before it counts.
"""

from __future__ import annotations

import contextlib
from collections.abc import Awaitable, Callable, Mapping, Sequence
from typing import Literal

from ...calc.tmcl.assembler import Assembly, assemble
from ...calc.tmcl.binary import command_bytes, command_of
from ...calc.tmcl.instructions import Command, InstructionSet
from ...errors import BadReply, BenchError, LinkError, LinkTimeout, OutOfRange, UsageError, WriteRefused, WrongState
from ...links.download import DownloadHold
from ...links.queue import Priority, Turn
from ...links.tmcl import FRAME_BYTES, Reply, Request, check_reply, sound
from ...links.tmcl_language import INSTRUCTIONS, standard_include, standard_includes
from ...registers.model import Register, Space
from ...registers.tmcl.commands import CONTROL_FIRST, PROGRAM_COMMANDS, Opcode, Status
from ..core.capabilities import ProgramMemory, ProgramSteps
from ..core.results import ProgramDownload, ProgramState
from ..core.session import Session
from ..core.tmcl_console import Console
from ..core.tmcl_link import TmclLink
from ..core.tmcl_refusals import refusal
from .moving_writes import MovingWrites
from .ongoing import OngoingMotion
from .program_steps import Steps
from .state import ModuleState

TRIES = 5
"""How often one command is sent, or read, before the line counts as failed."""
_STATUS: tuple[Literal["stopped", "running", "stepping", "reset"], ...] = ("stopped", "running", "stepping", "reset")
_ACCUMULATOR, _X = 2, 3
_CURRENT, _ADDRESS = 0, 1


class ProgramStore(ProgramMemory):
    """Of the module of `link`; what starts and stops goes through `console`, which knows what may move."""

    def __init__(
        self,
        session: Session,
        state: ModuleState,
        link: TmclLink,
        download: DownloadHold,
        ongoing: OngoingMotion,
        console: Console,
        moving: MovingWrites,
        relearn: Callable[[], Awaitable[None]],
    ) -> None:
        """`relearn` reads again what the driver forgets when the module is in download mode."""
        self._relearn = relearn
        self._session = session
        self._state = state
        self._link = link
        self._download = download
        self._ongoing = ongoing
        self._console = console
        self._moving = moving

    @property
    def instructions(self) -> InstructionSet:
        return INSTRUCTIONS

    def assemble(self, text: str, files: Mapping[str, str], name: str = "program") -> Assembly:
        module = self._state.module
        return assemble(
            text,
            INSTRUCTIONS,
            name=name,
            resolve=lambda file: files[file] if file in files else standard_include(module, file),
        )

    def includes(self) -> Mapping[str, str]:
        return standard_includes(self._state.module)

    # --- memory ----------------------------------------------------------------------------------

    async def download(self, commands: Sequence[Command], address: int = 0) -> ProgramDownload:
        self._session.require_connected()
        if not commands:
            raise UsageError("a program without commands cannot be stored; expected at least one")
        _check_span(address, len(commands))
        if self._ongoing.moves:
            raise WrongState("the motor moves, and in download mode nobody could look at it", "stop it first")
        requests = [Request(self._link.address, *command) for command in commands]
        for request in requests:
            if request.opcode >= CONTROL_FIRST:
                raise OutOfRange("opcode of a command of a program", request.opcode, 0, CONTROL_FIRST - 1)
            if self._session.limiter is not None:
                await self._session.limiter.learn_for(request.opcode, request.type, request.value)
            self._link.check_limits(request)
        self._state.program_started = False
        try:
            sent_again = await self._download_all(commands, requests, address)
        finally:
            if self._session.state == "connecting" and self._download.problem is None:
                # The way back from download mode was confirmed: nobody has to wait for the next look at the device.
                await self._back()
        return ProgramDownload(address, len(commands), sent_again)

    async def _back(self) -> None:
        with contextlib.suppress(BenchError):  # the device's watch tries again, and tells
            await self._relearn()
            if self._session.limiter is not None:
                await self._session.limiter.learn()
            self._session.set_state("connected")

    async def _download_all(self, commands: Sequence[Command], requests: Sequence[Request], address: int) -> int:
        """Store and read back; how many commands were sent again."""
        guard = self._session.stop_guard([0])
        async with self._session.queue.turn(Priority.COMMAND, guard, by_hand=True) as turn:
            leave = Request(self._link.address, Opcode.EXIT_DOWNLOAD)
            try:
                sent_again = await self._store(turn, requests, address)
            except BaseException:
                if self._download.problem is not None:
                    with contextlib.suppress(BenchError):  # what went wrong first is what is told
                        await self._confirmed(turn, leave)
                raise
            await self._confirmed(turn, leave)
            for at, command in enumerate(commands, address):
                await self._verify(turn, at, command)
        return sent_again

    async def read_program(self, address: int, count: int) -> list[Command]:
        self._session.require_connected()
        _check_span(address, count)
        async with self._session.queue.turn(Priority.COMMAND) as turn:
            return [await self._read(turn, at) for at in range(address, address + count)]

    async def _store(self, turn: Turn, requests: Sequence[Request], address: int) -> int:
        """Store all; how many were sent again."""
        await self._confirmed(turn, Request(self._link.address, Opcode.ENTER_DOWNLOAD, 0, 0, address))
        again = 0
        for at, request in enumerate(requests, address):
            for tries_left in reversed(range(TRIES)):
                try:
                    reply = await self._ask(turn, request)
                except (BadReply, LinkTimeout):
                    if not tries_left:
                        raise
                    again += 1
                    await self._confirmed(turn, Request(self._link.address, Opcode.ENTER_DOWNLOAD, 0, 0, at))
                    continue
                if reply.status == Status.STORED:
                    break
                if reply.status == Status.OK:
                    raise WrongState(
                        f"the module did command {at} instead of storing it: it has left download mode by itself",
                        "see to its supply, then download again",
                    )
                raise refusal(request, reply)
        return again

    async def _verify(self, turn: Turn, at: int, command: Command) -> None:
        found = command
        for _ in range(TRIES):
            found = await self._read(turn, at)
            if found == command:
                return
        raise WriteRefused(
            f"command {at} of the program",
            int.from_bytes(command_bytes(command), "big"),
            int.from_bytes(command_bytes(found), "big"),
            "download it again",
        )

    async def _read(self, turn: Turn, at: int) -> Command:
        request = Request(self._link.address, Opcode.READ_MEMORY, 0, 0, at)
        answer = await self._raw(turn, request)
        if sound(answer) and answer[1] == self._link.address and answer[3] == Opcode.READ_MEMORY:
            reply = Reply.decode(answer)  # an error has the usual form
            if not reply.ok:
                raise refusal(request, reply)
        return command_of(answer[1:8])

    async def _confirmed(self, turn: Turn, request: Request) -> None:
        """A control command that makes no difference when it is done twice."""
        for tries_left in reversed(range(TRIES)):
            try:
                reply = await self._ask(turn, request)
            except (BadReply, LinkTimeout):
                if not tries_left:
                    raise
                continue
            if reply.status != Status.OK:
                raise refusal(request, reply)
            return

    async def _ask(self, turn: Turn, request: Request) -> Reply:
        frame = request.encode()
        reply = check_reply(self._session.port.name, frame, await turn.exchange(frame))
        if reply.status == Status.WRONG_CHECKSUM:
            raise BadReply(self._session.port.name, "a command arrived garbled and was not stored", reply.encode())
        return reply

    async def _raw(self, turn: Turn, request: Request) -> bytes:
        for tries_left in reversed(range(TRIES)):
            try:
                answer = await turn.exchange(request.encode())
            except LinkTimeout:
                if not tries_left:
                    raise
                continue
            if len(answer) == FRAME_BYTES:
                return answer
        raise BadReply(self._session.port.name, f"no whole answer to {Opcode(request.opcode).name}", answer)

    # --- running ---------------------------------------------------------------------------------

    async def run_program(self, address: int | None = None) -> None:
        if address is None:
            await self._control(Opcode.RUN_APPLICATION, _CURRENT, 0)
        else:
            _check_span(address, 1)
            await self._control(Opcode.RUN_APPLICATION, _ADDRESS, address)

    async def stop_program(self) -> None:
        await self._control(Opcode.STOP_APPLICATION)

    async def step_program(self) -> None:
        await self._control(Opcode.STEP_APPLICATION)

    async def reset_program(self) -> None:
        await self._control(Opcode.RESET_APPLICATION)

    async def _control(self, opcode: Opcode, type_: int = 0, value: int = 0) -> None:
        done = await self._console.tmcl(opcode, type_, 0, value)
        if done.status != Status.OK or done.reply is None:
            request = Request(self._link.address, opcode, type_, 0, value)
            if done.status is None or done.reply is None:
                raise LinkError(self._session.port.name, f"{done.text}: whether it was done is not known")
            raise refusal(request, Reply.decode(done.reply))

    def stepping(self, what: str) -> ProgramSteps:
        self._session.require_connected()
        if self._download.problem is not None:
            raise self._download.problem
        counter = self._row("tmcl_program_counter")
        if counter is None:
            raise WrongState(
                f"{self._session.name} does not tell its program counter, so nobody could say where to halt",
                "run it without breakpoints, or step by hand",
            )
        self._session.commanded(0, what)
        return Steps(self._session, self._state, self._link, self._ongoing, self._moving, counter)

    # --- looking ---------------------------------------------------------------------------------

    def state_questions(self, variables: int) -> int:
        told = ("tmcl_application_status", "tmcl_program_counter", "download_mode", "last_tmcl_error")
        return sum(self._row(name) is not None for name in told) + len((_ACCUMULATOR, _X)) + variables

    async def program_state(self, variables: Sequence[int] = (), priority: Priority = Priority.COMMAND) -> ProgramState:
        self._session.require_connected()
        rows = [self._variable(number) for number in variables]
        status, counter, downloading, error = (
            self._row(name)
            for name in ("tmcl_application_status", "tmcl_program_counter", "download_mode", "last_tmcl_error")
        )
        needed = [row for row in (status, counter, downloading) if row is not None]
        async with self._link.calls(priority=priority) as calls:
            found = await calls.get_many([*needed, *rows])
            if status is not None and counter is not None:
                self._state.program.saw(found[0], found[1])
            last = (await calls.ask_many((error,)))[0] if error is not None else None
            accumulator, x = [
                (await calls.do(Request(self._link.address, Opcode.GET_STATUS, what))).value
                for what in (_ACCUMULATOR, _X)
            ]
        if not 0 <= found[0] < len(_STATUS):
            raise BadReply(self._session.port.name, f"status {found[0]} of the program is none of 0..3", b"")
        return ProgramState(
            status=_STATUS[found[0]],
            counter=found[1],
            downloading=bool(found[2]),
            accumulator=accumulator,
            x=x,
            error=last,
            variables=dict(zip(variables, found[len(needed) :], strict=True)),
        )

    def _row(self, name: str) -> Register | None:
        found = self._state.table.find(name, None)
        return None if found is None else found[0]

    def _variable(self, number: int) -> Register:
        row = self._state.table.at(number, Space.GLOBAL_2)
        if row is None:
            raise OutOfRange("number of a variable", number, 0, 255)
        return row


def _check_span(address: int, count: int) -> None:
    if not 0 <= address < PROGRAM_COMMANDS:
        raise OutOfRange("address of the program", address, 0, PROGRAM_COMMANDS - 1)
    if not 1 <= count <= PROGRAM_COMMANDS - address:
        raise OutOfRange("number of commands", count, 1, PROGRAM_COMMANDS - address, "what the memory has left there")
