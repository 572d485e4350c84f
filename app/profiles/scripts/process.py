"""Running programs that we made, in a folder that goes away: bounded time, bounded words, nothing of our secrets."""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import secrets
import signal
import sys
import tempfile
from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

GUEST = f"{__package__}.guest"
START_WITHIN_S = 60.0
"""A first start compiles the emulators [s]."""
RUN_WITHIN_S = 60.0
"""How long a script may take [s]: some hundred calls, on a machine that is busy."""
SAID_AT_MOST = 4000
"""Characters of what a program said that are told on."""
_PASSED_ON = ("PATH", "PYTHONPATH", "SYSTEMROOT", "LD_LIBRARY_PATH")
_ADDRESS = re.compile(rb"stepscope is at (http://127\.0\.0\.1:\d+)")


@dataclass(frozen=True, slots=True)
class Ended:
    """A program that is over, and its last words."""

    code: int
    said: str


@dataclass(frozen=True, slots=True)
class Guest:
    """A server that nobody else knows of."""

    url: str
    token: str
    folder: Path


@asynccontextmanager
async def temporary_folder() -> AsyncIterator[Path]:
    """An empty folder that only we may read; gone afterwards."""
    folder = await asyncio.to_thread(
        tempfile.TemporaryDirectory, prefix="stepscope-script-", ignore_cleanup_errors=True
    )
    try:
        yield Path(folder.name)
    finally:
        await asyncio.to_thread(folder.cleanup)


@asynccontextmanager
async def guest_server(folder: Path) -> AsyncIterator[Guest]:
    """A server without devices on a free port of the loopback address. Raises OSError with its words."""
    token = secrets.token_urlsafe(24)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("STEPSCOPE_")}
    arguments = ("serve", "--host", "127.0.0.1", "--port", "0", "--no-demo", "--data-dir", str(folder / "data"))
    log = folder / "server.log"
    with log.open("wb") as errors:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-P", "-m", GUEST, *arguments),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=errors,
            cwd=folder,
            env={**environment, "STEPSCOPE_TOKEN": token},
            start_new_session=True,
        )
    try:
        yield Guest(await _address(process, log), token, folder)
    finally:
        await _end(process)


async def _address(process: asyncio.subprocess.Process, log: Path) -> str:
    assert process.stdout is not None
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(START_WITHIN_S):
            async for line in process.stdout:
                found = _ADDRESS.search(line)
                if found:
                    return found[1].decode()
    words = await asyncio.to_thread(log.read_text, errors="replace")
    raise OSError(f"the server for the trial did not start: {words[-SAID_AT_MOST:].strip() or 'it said nothing'}")


async def run(command: Sequence[str], folder: Path, environment: Mapping[str, str] | None = None) -> Ended:
    """Run a program in `folder`, at most `RUN_WITHIN_S`. Raises OSError where there is no such program."""
    passed_on = {name: os.environ[name] for name in _PASSED_ON if name in os.environ}
    own = {"HOME": str(folder), "TMPDIR": str(folder), "LC_ALL": "C.UTF-8", "NO_PROXY": "*", "no_proxy": "*"}
    words = folder / "said.txt"
    with words.open("wb") as said:
        process = await asyncio.create_subprocess_exec(
            *command,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=said,
            stderr=asyncio.subprocess.STDOUT,
            cwd=folder,
            env={**passed_on, **own, **(environment or {})},
            start_new_session=True,
        )
    try:
        async with asyncio.timeout(RUN_WITHIN_S):
            code = await process.wait()
    except TimeoutError:
        return Ended(-1, f"it was not done after {RUN_WITHIN_S:g} s")
    finally:
        await _end(process)
    return Ended(code, await asyncio.to_thread(_read, words))


def _read(words: Path) -> str:
    with words.open("rb") as file:
        return file.read(1 << 20).decode(errors="replace")


async def _end(process: asyncio.subprocess.Process) -> None:
    """End a program with all that it began; for what runs on after that there is the end of our own process."""
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            if sys.platform == "win32":
                process.kill()
            else:
                os.killpg(process.pid, signal.SIGKILL)
        await process.wait()
