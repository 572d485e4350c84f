"""The drawing process as the server has it: started, told what to show, and ended."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import sys
from collections import deque
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from ..errors import BenchError

START_WITHIN_S = 30.0
"""How long the process may take until it answers [s]: a cold disk and a busy machine count."""
ANSWER_WITHIN_S = 10.0
END_WITHIN_S = 1.0
SAID_LINES = 20
SAID_LENGTH = 300
LINE_BYTES = 64 * 1024


class TwinFailed(BenchError):
    """The drawing process did not start, or has ended. `way_out` says what to do."""

    def __init__(self, reason: str) -> None:
        super().__init__(f"the process that draws the 3D view {reason}")
        self.reason = reason
        self.way_out = "start the view again; where that keeps failing, `pip install viser` may be incomplete"


@dataclass(frozen=True, slots=True)
class Address:
    """Where the process serves its page, and what the page's content security policy has to allow.

    scripts : hashes of the page's scripts as CSP sources without quotes; empty where they could not be told
    """

    port: int
    scripts: tuple[str, ...]
    host: str = "127.0.0.1"


class Renderer(Protocol):
    """What draws. Both calls raise TwinFailed where it has ended."""

    @property
    def address(self) -> Address: ...

    @property
    def pid(self) -> int: ...

    async def show(self, message: dict[str, Any]) -> None:
        """Have a message shown; returns when it is, so that a slow one is not given more than it can show."""
        ...

    async def ended(self) -> TwinFailed:
        """Wait until it has ended by itself, and tell why."""
        ...

    async def close(self) -> None:
        """End it; nothing of it is left on return. A second call does nothing."""
        ...


StartRenderer = Callable[[], Awaitable[Renderer]]


class DrawingProcess:
    """The module `child` as a program, over its standard streams."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process
        self._said: deque[str] = deque(maxlen=SAID_LINES)
        self._hearing = asyncio.create_task(self._hear(), name="twin process")
        self._address = Address(0, ())

    @classmethod
    async def start(cls) -> DrawingProcess:
        """Start one and wait until it serves. Raises TwinFailed."""
        # This package and no other of that name; and nothing that viser would take a port from.
        environment = {name: value for name, value in os.environ.items() if not name.startswith("_VISER")}
        environment["PYTHONPATH"] = str(Path(__file__).parents[2])
        try:
            process = await asyncio.create_subprocess_exec(
                sys.executable,
                "-P",
                "-m",
                f"{__package__}.child",
                stdin=asyncio.subprocess.PIPE,
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.PIPE,
                env=environment,
                limit=LINE_BYTES,
                start_new_session=True,  # Ctrl-C in the terminal is the server's, who ends this one after the motors
            )
        except OSError as error:
            raise TwinFailed(f"could not be started: {error}") from error
        started = cls(process)
        try:
            ready = (await started._answer(START_WITHIN_S))["ready"]
            started._address = Address(int(ready["port"]), tuple(ready["scripts"]))
        except BaseException:
            await started.close()
            raise
        return started

    @property
    def address(self) -> Address:
        return self._address

    @property
    def pid(self) -> int:
        return self._process.pid

    async def show(self, message: dict[str, Any]) -> None:
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(message).encode() + b"\n")
            await self._process.stdin.drain()
        except (BrokenPipeError, ConnectionResetError) as error:
            raise await self._ended() from error
        if "look" in message:
            await self._answer(ANSWER_WITHIN_S)

    async def ended(self) -> TwinFailed:
        await self._process.wait()
        return await self._ended()

    async def close(self) -> None:
        if self._process.stdin is not None:
            self._process.stdin.close()
        try:
            async with asyncio.timeout(END_WITHIN_S):
                await self._process.wait()
        except TimeoutError:
            with contextlib.suppress(ProcessLookupError):
                self._process.kill()
            await self._process.wait()
        finally:
            self._hearing.cancel()
            await asyncio.gather(self._hearing, return_exceptions=True)

    async def _answer(self, within_s: float) -> dict[str, Any]:
        """Its next line. Raises TwinFailed where none comes."""
        assert self._process.stdout is not None
        try:
            async with asyncio.timeout(within_s):
                line = await self._process.stdout.readline()
        except TimeoutError as error:
            raise TwinFailed(f"has not answered for {within_s:g} s") from error
        if not line:
            raise await self._ended()
        answer: dict[str, Any] = json.loads(line)
        return answer

    async def _ended(self) -> TwinFailed:
        """Why it is no more, in its own last words."""
        with contextlib.suppress(TimeoutError):
            # Its pipe is closed, so it is ending by itself: on a busy machine that takes longer than being told to.
            async with asyncio.timeout(ANSWER_WITHIN_S):
                await self._process.wait()
                await asyncio.shield(self._hearing)
        code = self._process.returncode
        how = "does not answer" if code is None else f"was ended by signal {-code}" if code < 0 else f"ended ({code})"
        words = next((line for line in reversed(self._said) if line.strip()), "")
        return TwinFailed(f"{how}{': ' + words if words and code is not None and code > 0 else ''}")

    async def _hear(self) -> None:
        """Keep its last words; it must never wait because nobody reads them."""
        assert self._process.stderr is not None
        begun = ""  # a line may come in several pieces
        while chunk := await self._process.stderr.read(4096):
            *lines, begun = (begun + chunk.decode(errors="replace")).split("\n")
            self._said.extend(line.strip()[:SAID_LENGTH] for line in lines)
            begun = begun[:SAID_LENGTH]
        self._said.append(begun.strip())
